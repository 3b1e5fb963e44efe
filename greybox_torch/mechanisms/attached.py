"""All effects of a model, in whatever layers they were attached."""

from __future__ import annotations

from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.ports import Actuator


def attached(model: GreyBoxModel) -> tuple[GreyBoxModel, list[Attachment], dict[str, Surroundings]]:
    """The model without effects, all its effects, and what they know of their ports.

    In one layer the effects do what they do in several: what is attached to a model with effects acts on an input before these do, and on
    an output after them.
    """
    attachments: list[Attachment] = []
    surroundings: dict[str, Surroundings] = {}
    actuators = {port.name for port in model.plain.all_ports if isinstance(port, Actuator)}
    while isinstance(model, AugmentedModel):
        inner = model.attachments
        before = [a for a in attachments if a.port in actuators]
        attachments = [*before, *inner, *(a for a in attachments if a.port not in actuators)]
        surroundings = {**model.surroundings, **surroundings}
        model = model.base
    return model, attachments, surroundings
