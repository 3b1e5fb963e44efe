from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.estimate.metrics import fit_percent, root_mean_square

NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize(
    ("measured", "simulated", "fit", "rms"),
    [
        ([1.0, 2.0, 3.0], [1.0, 2.0, 3.0], 100.0, 0.0),
        ([1.0, 2.0, 3.0], [2.0, 2.0, 2.0], 0.0, np.sqrt(2 / 3)),  # no better than the mean
        ([1.0, 2.0, 3.0], [3.0, 2.0, 1.0], -100.0, np.sqrt(8 / 3)),
        ([1.0, NAN, 3.0], [1.0, 77.0, 3.0], 100.0, 0.0),  # missing samples carry no weight
        ([1.0, NAN, 3.0], [1.0, INF, 3.0], 100.0, 0.0),
        ([1.0, 2.0, 3.0], [1.0, INF, 3.0], -INF, INF),
        ([1.0, 2.0, 3.0], [1.0, NAN, 3.0], -INF, INF),
        ([2.0, 2.0, 2.0], [2.0, 2.0, 3.0], -INF, np.sqrt(1 / 3)),  # nothing to explain
    ],
)
def test_figures(measured: list[float], simulated: list[float], fit: float, rms: float) -> None:
    y, s = np.array(measured), np.array(simulated)
    assert fit_percent(y, s) == pytest.approx(fit)
    assert root_mean_square(y, s) == pytest.approx(rms)
