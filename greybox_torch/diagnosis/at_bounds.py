"""Parameters of the model itself that ended at one of their bounds."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.estimate.notes import told_at_bound, with_value
from greybox_torch.name_lists import listed

Value = tuple[float, float | None] | None
"""An estimate and its standard deviation."""


def own_at_bounds(
    estimates: Sequence[tuple[str, str, Value, Value, tuple[bool, bool]]], effects: bool
) -> tuple[str, ...]:
    """A sentence on those that are at a bound in the model as it stands, re-estimated, or in the one with effects; none elsewhere.

    Args:
        estimates: the name of each, its unit, its value in the one and in the other, and whether these are at a bound.
        effects: whether there is a model with effects.
    """
    told, beside = [], []
    for name, unit, *values, at_bound in estimates:
        refit, augmented = (
            with_value(name, v[0], unit) if v and at else "" for v, at in zip(values, at_bound, strict=True)
        )
        if effects and augmented and values[1] and values[1][0] != 0.0:  # zero is a limit of physics
            beside.append(name)
        if not effects:
            told.append(refit)
        elif refit == augmented:
            told.append(refit and f"{refit} (without and with the effects)")
        else:
            told.append(refit and f"{refit} (without the effects)")
            told.append(augmented and f"{augmented} (with the effects)")
    named = listed([one for one in told if one])
    if not named:
        return ()
    if not beside:
        return (f"{told_at_bound(named)}.",)
    hold = f"With the effects {listed(beside)} may go no further: if the truth lies beyond, effects and refinements make up for it"
    return (f"{told_at_bound(named)}. {hold}, and their values are wrong.",)
