"""How far along a record sensitivities say what a change of a parameter would do."""

from __future__ import annotations

import numpy as np


def trusted(slopes: np.ndarray, values: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """The ``slopes`` (N, n_y, n_d) of a record, zero from where they have grown out of all proportion.

    Where a machine all but slips out of a detent, or all but stays in it, the least change of any parameter decides between two motions.
    Slopes grow to millions there, and hold for changes of a millionth alone: taken at their word, they determine everything. In a machine
    that does not do so they grow with the time at most, so that one parameter, changed by its own size, moves an output by no more than the
    output's size times the number of samples.

    Args:
        values: of the parameters (n_p,), by which the first slopes are.
        sizes: of the outputs (n_y,), in their units: the largest, or the errors' where they stand at zero.
    """
    count = len(slopes)
    with np.errstate(all="ignore"):
        moved = np.abs(slopes[:, :, : len(values)] * values).max(axis=2, initial=0.0)
        beyond = (moved > count * np.maximum(sizes, 1e-300)).any(axis=1)
    if not beyond.any():
        return slopes
    kept = slopes.copy()
    kept[int(np.argmax(beyond)) :] = 0.0
    return kept
