"""How many Runge-Kutta steps a sample needs."""

from __future__ import annotations

import numpy as np

from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.stepper import Stepper
from greybox_torch.simulation.windows import Windows

LARGEST = 64


TOLERANCE = 3e-4
"""Part of an output's spread by which it may change where the steps are halved."""


def choose_substeps(
    records: Records, stepper: Stepper, p: np.ndarray, starts: np.ndarray, *, tolerance: float = TOLERANCE
) -> int | None:
    """The smallest power of two for which doubling the steps changes no output by more than ``tolerance`` of its spread.

    Judged on the first stretch of every experiment from its start state ``starts`` (E, n_x), with parameters ``p`` (n_p,).

    Returns:
        The number of sub-steps; ``LARGEST`` where only accuracy is in doubt; None where not even that many give finite numbers.
    """
    asked = Pass(Windows(records.first, records.last, judged_steps(records)), p, starts)
    limit = tolerance * output_spread(records)
    coarse, substeps = stepper.run(records, asked).y, 1
    while substeps <= LARGEST:
        fine = stepper.run(records, asked, 2 * substeps).y
        if fine_enough(coarse, fine, limit, records.lengths):
            return substeps
        coarse, substeps = fine, 2 * substeps
    return LARGEST if all_finite(coarse, records.lengths) else None


def judged_steps(records: Records) -> int:
    """Of how many samples the stretch is that sub-steps are judged on."""
    longest = int(records.lengths.max())
    return min(longest, max(200, longest // 10))


def output_spread(records: Records) -> np.ndarray:
    """The spread (n_y,) of the measured outputs, one where there is none."""
    spread = np.nanstd(records.y, axis=1)
    return np.where(spread > 0, spread, 1.0)


def fine_enough(coarse: np.ndarray, fine: np.ndarray, limit: np.ndarray, lengths: np.ndarray) -> bool:
    """Whether outputs (E, N, n_y) of experiments of ``lengths`` (E,) with steps of two lengths differ by less than ``limit`` (n_y,)."""
    if not (all_finite(coarse, lengths) and all_finite(fine, lengths)):
        return False
    with np.errstate(over="ignore"):  # steps that are too long give numbers of any size
        apart = _recorded(fine, lengths) - _recorded(coarse, lengths)
        return bool((np.sqrt(np.mean(apart**2, axis=0)) <= limit).all())


def all_finite(y: np.ndarray, lengths: np.ndarray) -> bool:
    """Whether all outputs (E, N, n_y) that experiments of ``lengths`` (E,) have are finite."""
    return bool(np.isfinite(_recorded(y, lengths)).all())


def _recorded(y: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    """Of outputs (E, N, n_y) those that the experiments have, (samples, n_y): a run goes on beyond the end of a shorter one."""
    return y[np.arange(y.shape[1]) < lengths[:, None]]
