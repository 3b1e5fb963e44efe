"""What signals a law reads, which may be more than it needs: where a coupling's rate is known, the play of a gear is damped by it."""

from __future__ import annotations

import torch

from greybox_torch.errors import UserError
from greybox_torch.mechanisms.mechanism import Mechanism
from greybox_torch.mechanisms.surroundings import Surroundings
from greybox_torch.model import Signals
from greybox_torch.model.signals import parameter_signals


def reads_nothing_but(law: Mechanism, around: Surroundings, signal: str) -> bool:
    """Whether the force of a law without states can be computed from one signal alone."""
    declared = {parameter.name: parameter.value for parameter in law.parameters(around)}
    alone = Signals("signal", {signal: torch.zeros(1, dtype=torch.float64)})
    try:
        law.force(alone, parameter_signals(declared), Signals("state", {}))
    except UserError:
        return False
    return True
