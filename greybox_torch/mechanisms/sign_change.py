"""The sign of a speed, smooth enough for a solver to follow, and dry friction that changes with it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import torch

from greybox_torch.mechanisms.linear_law import LinearLaw
from greybox_torch.mechanisms.mechanism import Probe, Surroundings
from greybox_torch.model import Parameter, Signals

WIDTH = "v_0"
"""Name of the speed over which dry friction changes its sign."""


def smooth_sign(speed: Any, width: Any) -> Any:
    """tanh(v / v_0), the sign of a speed with a transition that a solver can follow."""
    return torch.tanh(speed / width)


def width_parameter(around: Surroundings, begun: float = 0.03) -> Parameter:
    """The speed v_0 over which a Coulomb force changes its sign: no more than a tenth of the fastest, or it would grow with speed.

    Args:
        begun: its start value, as a share of the fastest.
    """
    reach = around.ranges["speed"].reach
    unit = around.units.get("speed", "")
    return Parameter(
        "v_0", begun * reach, unit, lower=2e-3 * reach, upper=0.1 * reach, description="width of the sign change"
    )


def widths(around: Surroundings) -> list[float]:
    """Widths of the sign change that a screen looks at."""
    reach = around.ranges["speed"].reach
    return [0.005 * reach, 0.03 * reach, 0.1 * reach]


class DryLaw(LinearLaw):
    """Dry friction of a level that is proportional to one parameter; the force changes its sign with the speed, over a width v_0.

    A subclass writes :meth:`law`, the force while the speed is positive and large, and the class attributes of :class:`LinearLaw`.
    """

    natural = (WIDTH,)

    def parameters(self, around: Surroundings) -> list[Parameter]:
        return [*self.beside(around), self.size(around), self.change_of_sign(around)]

    def beside(self, around: Surroundings) -> list[Parameter]:
        """Further levels that a form of the law has."""
        return []

    def change_of_sign(self, around: Surroundings) -> Parameter:
        """Within what the force changes its sign."""
        return width_parameter(around)

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return self.law(s, p[self.parameter]) * smooth_sign(s.speed, p.v_0)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe((self.parameter,), {"v_0": width}) for width in widths(around)]

    def begun_elsewhere(self, around: Surroundings, values: Mapping[str, float]) -> Sequence[Mapping[str, float]]:
        """With a wide change of sign: from a sharp one no refit moves where the machine sticks and slips."""
        return [{"v_0": widths(around)[-1]}]
