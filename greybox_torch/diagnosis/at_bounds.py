"""Parameters of the model itself that ended at one of their bounds."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.estimate.notes import told_at_bound
from greybox_torch.name_lists import listed


def own_at_bounds(estimates: Sequence[tuple[str, bool, bool]], effects: bool) -> tuple[str, ...]:
    """A sentence on those that are at a bound in the model as it stands, re-estimated, or in the one with effects; none elsewhere.

    Args:
        estimates: the name of each, and whether it is at a bound in the one and in the other.
        effects: whether there is a model with effects.
    """
    if not effects:
        names = [name for name, refit, _ in estimates if refit]
    else:
        where = {(True, False): " (without the effects)", (False, True): " (with the effects)", (True, True): ""}
        names = [name + where[refit, augmented] for name, refit, augmented in estimates if refit or augmented]
    return (f"{told_at_bound(listed(names))}.",) if names else ()
