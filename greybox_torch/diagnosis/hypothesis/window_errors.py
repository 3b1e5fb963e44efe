"""What a fit over windows leaves, sample by sample."""

from __future__ import annotations

import numpy as np

from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.simulator import Simulator


def window_errors(fit: WindowFit, simulator: Simulator) -> np.ndarray:
    """Measured minus simulated over fitted windows (n_y, N), in output units; NaN where a sample is missing
    or shows what was before the record."""
    problem, windows = fit.problem, fit.windows
    run = simulator.run(problem.driving_records, Pass(windows, problem.values, fit.starts))
    simulated = np.full(problem.records.y.shape, np.nan)
    for w, (first, last) in enumerate(zip(windows.start, windows.last, strict=True)):
        simulated[:, first : last + 1] = run.y[w, : last - first + 1].T
    return problem.window_records.y - simulated
