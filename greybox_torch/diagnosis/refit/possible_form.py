"""Whether a law has what it needs at its port in a form with more parameters."""

from __future__ import annotations

from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.actuator import TorqueSaturation
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.model.mechanics import driven
from greybox_torch.model.ports import Actuator, driving_body


def possible_form(study: Study, law: Attachment) -> bool:
    """Whether the signals that it needs are there; of a limit that falls with speed, that of the body which its input drives.

    The speed at an actuator is that of the first body of a model, which another input may drive.
    """
    if not law.mechanism.available(study.surroundings[law.port]):
        return False
    if not (isinstance(law.mechanism, TorqueSaturation) and law.mechanism.limited_power):
        return True
    model = study.problem.model
    site, first = next(q for q in model.all_ports if q.name == law.port), driving_body(model.ports)
    pushed = driven(model, site.input) if isinstance(site, Actuator) else None
    return pushed is not None and first is not None and pushed[0] == first.name
