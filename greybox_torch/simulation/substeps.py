"""How many Runge-Kutta steps a sample needs."""

from __future__ import annotations

import numpy as np

from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.stepper import Stepper
from greybox_torch.simulation.windows import Windows

LARGEST = 64


def choose_substeps(
    records: Records, stepper: Stepper, p: np.ndarray, starts: np.ndarray, *, tolerance: float = 3e-4
) -> int | None:
    """The smallest power of two for which doubling the steps changes no output by more than ``tolerance`` of its spread.

    Judged on the first stretch of every experiment from its start state ``starts`` (E, n_x), with parameters ``p`` (n_p,).

    Returns:
        The number of sub-steps; ``LARGEST`` where only accuracy is in doubt; None where not even that many give finite numbers.
    """
    windows = Windows(
        records.first, records.last, int(min(records.lengths.max(), max(200, records.lengths.max() // 10)))
    )
    spread = np.nanstd(records.y, axis=1)
    limit = tolerance * np.where(spread > 0, spread, 1.0)
    asked = Pass(windows, p, starts)
    coarse, substeps = stepper.run(records, asked).y, 1
    while substeps <= LARGEST:
        fine = stepper.run(records, asked, 2 * substeps).y
        finite = np.isfinite(coarse).all() and np.isfinite(fine).all()
        with np.errstate(over="ignore"):  # steps that are too long give numbers of any size
            near = finite and (np.sqrt(np.mean((fine - coarse) ** 2, axis=(0, 1))) <= limit).all()
        if near:
            return substeps
        coarse, substeps = fine, 2 * substeps
    return LARGEST if np.isfinite(coarse).all() else None
