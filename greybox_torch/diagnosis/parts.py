"""The sizes of several effects beside what these account for together."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.one_of import spoken_at
from greybox_torch.name_lists import listed

SMALL_PARTS = 0.5
"""Share of what effects account for together below which the sum of their sizes is told to be small."""


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
