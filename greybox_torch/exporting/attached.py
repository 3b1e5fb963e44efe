"""All effects of a model, in whatever layers they were attached."""

from __future__ import annotations

from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.model import GreyBoxModel


def attached(model: GreyBoxModel) -> tuple[GreyBoxModel, list[Attachment], dict[str, Surroundings]]:
    """The model without effects, its effects in the order in which they were attached, and what they know of their ports."""
    attachments: list[Attachment] = []
    surroundings: dict[str, Surroundings] = {}
    while isinstance(model, AugmentedModel):
        attachments[:0] = model.attachments
        surroundings = {**model.surroundings, **surroundings}
        model = model.base
    return model, attachments, surroundings
