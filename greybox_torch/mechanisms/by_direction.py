"""Laws of an input whose ends may differ by direction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import torch

from greybox_torch.mechanisms.mechanism import Mechanism, Surroundings
from greybox_torch.model import Parameter

PLAINLY_EVEN = 0.02
"""Share of a curve's square that its even part has where the two directions differ: by a tenth and more."""

LEAST_OF_EITHER_SIDE = 0.1
"""How far an input has to go to the one side, in shares of how far it goes to the other, to tell the two directions apart."""


class ByDirection(Mechanism):
    """A law of the input that is odd, or has a parameter ``asymmetry`` besides: 0.1 is a tenth more above zero and a tenth less below."""

    natural = ("asymmetry",)

    def __init__(self, by_direction: bool = False) -> None:
        self.by_direction = by_direction

    def asymmetry(self, of: str) -> list[Parameter]:
        """The parameter, where the law has it."""
        told = f"of {of}: 0.1 is a tenth more above, less below"
        return [Parameter("asymmetry", 0.0, "", lower=-0.9, upper=0.9, description=told)] if self.by_direction else []

    def richer(self, values: Mapping[str, float]) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        return () if self.by_direction else ((type(self)(True), {**values, "asymmetry": 0.0}),)

    def plainer(self, values: Mapping[str, float]) -> tuple[Mechanism, Mapping[str, float]] | None:
        if not self.by_direction:
            return None
        alike = {name: value for name, value in values.items() if name != "asymmetry"}
        return type(self)(**{**self.options(), "by_direction": False}), alike

    def nearest(
        self, around: Surroundings, signals: Mapping[str, torch.Tensor], force: np.ndarray, weight: np.ndarray
    ) -> Mechanism:
        return type(self)(plainly_not_odd(signals["input"].numpy(), force, weight))


def larger_forms(own: tuple[bool, bool]) -> list[tuple[bool, bool]]:
    """Of a law with two options, the pairs in which no option of its ``own`` is lost and another one joins, the first option first."""
    forms = ((True, False), (False, True), (True, True))
    return [form for form in forms if form != own and form[0] >= own[0] and form[1] >= own[1]]


def plainly_not_odd(signal: np.ndarray, change: np.ndarray, weight: np.ndarray) -> bool:
    """Whether a curve (N,) over a signal (N,), points counting by weight (N,), is not odd; False where it was on one side of zero only."""
    order = np.argsort(signal)
    signal, change, weight = signal[order], change[order], weight[order]
    shorter = min(-signal[0], signal[-1])
    if shorter < LEAST_OF_EITHER_SIDE * max(-signal[0], signal[-1]):
        return False
    both = np.abs(signal) <= shorter
    even = 0.5 * (change + np.interp(-signal, signal, change))
    return bool(weight[both] @ even[both] ** 2 > PLAINLY_EVEN * (weight @ change**2))
