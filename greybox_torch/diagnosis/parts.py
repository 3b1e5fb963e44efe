"""The sizes of effects beside what these account for together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.one_of import spoken_at
from greybox_torch.name_lists import listed

SMALL_PARTS = 0.5
"""Share of what effects account for together below which the sum of their sizes is told to be small."""

MORE_IS_LEFT = 0.1
"""By how much sizes and what remains come to more than the whole mismatch for that to be explained."""


def about_sizes(effects: Sequence[Effect], refinements: Sequence[Effect], left: float | None) -> tuple[str, ...]:
    """Sentences where the sizes are much less than what the effects account for together, or one is more than what remains leaves room for.

    Args:
        left: share of the mismatch that all of them leave, None where that is not known.
    """
    small = small_parts([(e.mechanism, e.port, e.size) for e in (*effects, *refinements)], left)
    if small or any(e.made_up_for for e in effects):
        return small
    return of_other_errors([e.size for e in effects], left)


def of_other_errors(sizes: Sequence[float], left: float | None) -> tuple[str, ...]:
    """A sentence where the size of one effect says that more has gone than what remains leaves room for; none elsewhere. Sizes of several
    need not add up.

    Seen: "size 100 %", and three lines below "36 % of the mismatch remains".
    """
    if left is None or not np.isfinite([*sizes, left]).all() or max(sizes, default=0.0) + left <= 1.0 + MORE_IS_LEFT:
        return ()
    return (
        "A size and what remains come to more than 100 %, as they are of different errors: sizes of those over windows, whose start states "
        "are estimated, and what remains of those of free runs, where errors last and add up.",
    )


def small_parts(effects: Sequence[tuple[str, str, float]], left: float | None) -> tuple[str, ...]:
    """A sentence where the sizes are small beside that, as what is left out is made up for; none elsewhere.

    Args:
        effects: mechanism, port and size of each, refinements among them.
        left: share of the mismatch that all of them leave, None where that is not known.
    """
    sizes = [size for *_, size in effects]
    if len(effects) < 2 or left is None or not np.isfinite(sizes).all() or sum(sizes) > SMALL_PARTS * (1.0 - left):
        return ()
    named = listed([spoken_at(mechanism, port) for mechanism, port, _ in effects])
    return (
        f"The sizes of {named} come to {digits(100 * sum(sizes))} % where together they account for {digits(100 * (1.0 - left))} % of the "
        "mismatch: where one is left out, the others and the model's parameters, estimated anew, make up for most of what it explains.",
    )
