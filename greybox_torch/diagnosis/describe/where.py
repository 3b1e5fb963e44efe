"""Where an effect acts, in words."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.diagnosis.describe.profiles import most_of
from greybox_torch.diagnosis.effect import Profile, Timeline
from greybox_torch.in_unit import in_unit

NEARLY_ALL = 0.75
"""Share of a signal's range from which an interval within it says nothing of where an effect is."""

LEAST_MORE = 0.1
"""By how much an interval's share of what an effect explains exceeds that of the samples for it to say anything."""


def where(
    profiles: Sequence[Profile], timelines: Sequence[Timeline], beyond: tuple[float | None, float | None] | None = None
) -> str:
    """In words: the first signal's interval that holds most of the explained error energy, and the experiment with most per second.

    Args:
        beyond: below and above which value of that signal the law acts alone, where it does so: errors elsewhere are what comes of that.
    """
    strongest = max(timelines, key=lambda t: t.intensity).experiment if len(timelines) > 1 else ""
    also = f", strongest in {strongest}" if strongest else ""
    if not profiles:
        return f"what it explains is spread over the whole recordings{also}"
    first = profiles[0]
    if beyond is not None:
        ends = [f"{first.signal} {sign} {end:.4g}" for sign, end in zip("<>", beyond, strict=True) if end is not None]
        return f"it acts where {in_unit(' or '.join(ends), first.unit)}{also}"
    low, high, share = most_of(first)
    within = (first.edges[:-1] >= low) & (first.edges[1:] <= high)
    if high - low > NEARLY_ALL * (first.edges[-1] - first.edges[0]) or (
        first.seen is not None and share < first.seen[within].sum() + LEAST_MORE
    ):
        return where((), timelines)
    inside = np.clip(first.levels, first.edges[0], first.edges[-1])
    levels = [v for v, i in zip(first.levels, inside, strict=True) if low <= i < high or i == high == first.edges[-1]]
    lies = (
        f"where {first.signal} = {levels[0]:.4g}"
        if len(levels) == 1
        else f"within {low:.3g} < {first.signal} < {high:.3g}"
    )
    return f"{100 * share:.0f} % of what it explains lies {in_unit(lies, first.unit)}{also}"
