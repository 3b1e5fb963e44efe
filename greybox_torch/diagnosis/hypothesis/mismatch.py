"""How large the mismatch of a model is beside the motion itself."""

from __future__ import annotations

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.noise import floor_known, noise_floor
from greybox_torch.diagnosis.settings import DiagnosisSettings


def mismatch_share(fitted: Hypothesis, settings: DiagnosisSettings) -> float:
    """Root mean square error beyond the noise, in units of the outputs' spread: the largest over the window lengths."""
    known = floor_known(fitted.problem, settings)  # else what looks like noise may be motion, and hide what is missing
    shares = []
    for fit in fitted.fits:
        spread = np.nanstd(fit.problem.records.y, axis=1) * fit.problem.weights
        whole = max(float(np.mean(spread**2)), 1e-300)
        shares.append(np.sqrt(max(fit.mean_square - known * noise_floor(fit.problem, settings), 0.0) / whole))
    return float(max(shares))
