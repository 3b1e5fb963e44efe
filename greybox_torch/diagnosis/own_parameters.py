"""The free parameters of the model itself, as a verdict gives them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from greybox_torch.estimate.brief_lists import brief_pairs
from greybox_torch.in_unit import in_unit

FAR_TIMES = 3.0
"""Times the value beside the effects from which one without them is far from it: what is missing biases it, and its deviation does not say
so.
"""


@dataclass(frozen=True)
class Estimate:
    """A free parameter of the model, in ``unit``: as the card has it, re-estimated, and with the effects (None where there are none).

    Standard deviations are None where they are not known. ``at_bound``: whether the two estimates are at a bound of the parameter.
    ``together``: by name those of the model that the last of these estimates hardly goes without, with their correlation.
    """

    name: str
    unit: str
    start: float
    refit: tuple[float, float | None]
    augmented: tuple[float, float | None] | None
    at_bound: tuple[bool, bool] = (False, False)
    together: Mapping[str, float] = field(default_factory=dict)

    @property
    def weak(self) -> bool:
        """Whether the last estimate is at a bound, or its deviation larger than itself."""
        value, deviation = self.refit if self.augmented is None else self.augmented
        return self.at_bound[0 if self.augmented is None else 1] or (deviation is not None and deviation > abs(value))


def determined_together(estimates: Sequence[Estimate]) -> tuple[str, ...]:
    """A sentence on those of which the recordings determine the one only with the other, where either is weak by itself; none elsewhere."""
    known = {one.name: one for one in estimates}
    pairs = [
        (one.name, other, correlation)
        for k, one in enumerate(estimates)
        for other, correlation in one.together.items()
        if other in [e.name for e in estimates[k + 1 :]] and (one.weak or known[other].weak)
    ]
    if not pairs:
        return ()
    return (
        f"Determined only together (correlation of the estimates): {brief_pairs(pairs)}. What one has too much the other has too little: "
        "fix the one that is known.",
    )


def far_refits(estimates: Sequence[Estimate]) -> tuple[str, ...]:
    """A sentence on those that were re-estimated far from what they are beside the effects; none elsewhere.

    Not of one that is at a bound in either estimate, which is told by itself, or of which the recordings do not determine one of them.
    """
    far = [
        f"{in_unit(f'{one.name} = {one.refit[0]:.4g}', one.unit)} ({one.augmented[0]:.4g} with them)"
        for one in estimates
        if one.augmented is not None
        and not any(one.at_bound)
        and one.refit[1] is not None
        and one.augmented[1] is not None
        and one.refit[1] < abs(one.refit[0])
        and math.hypot(one.refit[1], one.augmented[1]) < abs(one.augmented[0] - one.refit[0])
        and _times(one.augmented[0], one.refit[0]) > FAR_TIMES
    ]
    if not far:
        return ()
    it = "It" if len(far) == 1 else "They"
    return (
        f"Re-estimated without the effects: {', '.join(far)}. {it} may make up for what is missing. The error of such a model may "
        "also have several minima: `greybox fit`, which weighs the outputs otherwise, may end in another one with values as far off, and "
        "standard deviations say how well this minimum is known, not how far it is from the machine.",
    )


def _times(value: float, other: float) -> float:
    """By which factor the larger of two values exceeds the other; infinite where they differ in sign, or one of them is zero."""
    if value == other:
        return 1.0
    return max(value / other, other / value) if value * other > 0.0 else math.inf
