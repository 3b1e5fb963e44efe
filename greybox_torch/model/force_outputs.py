"""Outputs that are forces: a torque that is measured under a prescribed motion shows what acts at a port at once, without any state."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from greybox_torch.model.greybox_model import GreyBoxModel


def output_asks_for_forces(made: type[GreyBoxModel]) -> bool:
    """Whether a class of model defines ``output(self, x, u, p, port)``, with the forces at the ports, and not ``output(self, x, u, p)``."""
    arguments = inspect.signature(made.output).parameters.values()
    by_place = [a for a in arguments if a.kind in (a.POSITIONAL_ONLY, a.POSITIONAL_OR_KEYWORD)]
    return len(by_place) > 4  # self, x, u, p
