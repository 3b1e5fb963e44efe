"""What a fit over windows leaves, sample by sample."""

from __future__ import annotations

import numpy as np

from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.simulation.stepper import Stepper


def window_errors(fit: WindowFit, stepper: Stepper, substeps: int) -> np.ndarray:
    """Measured minus simulated over fitted windows (n_y, N), in output units; NaN where a sample is missing."""
    problem, windows = fit.problem, fit.windows
    run = stepper.run(problem.driving_records, windows, problem.values, fit.starts, substeps=substeps)
    simulated = np.full(problem.records.y.shape, np.nan)
    for w, (first, last) in enumerate(zip(windows.start, windows.last, strict=True)):
        simulated[:, first : last + 1] = run.y[w, : last - first + 1].T
    return problem.records.y - simulated
