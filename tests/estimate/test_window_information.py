"""What windows tell of parameters: the curvature of the error along them, window starts where they are best."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from greybox_torch.estimate.levenberg_marquardt import Settings
from greybox_torch.estimate.window_fit import fit_windows
from greybox_torch.estimate.window_information import window_information
from greybox_torch.simulation.simulator import Simulator

from .test_window_fit import fitted, recorded

STARTS_ONLY = Settings(iterations=60, tolerance=1e-13, trials=10)


def test_is_half_the_second_difference_of_the_error(data_set) -> None:
    found = fitted(recorded(data_set, 0.7))
    information = window_information(found, Simulator.of(found.problem.model, found.problem.free_names))
    assert information is not None
    np.testing.assert_allclose(information, information.T, rtol=1e-9)

    def error(values: np.ndarray) -> float:
        held = replace(found.problem.with_values(values), free=np.zeros(3, dtype=bool))
        again = fit_windows(held, Simulator.of(held.model, ()), 100, starts=found.starts, settings=STARTS_ONLY)
        assert again is not None
        return 0.5 * float(again.energies.sum())

    for k, size in enumerate((0.02, 0.02, 0.04)):
        step = size * np.eye(3)[k]
        second = error(found.problem.values + step) + error(found.problem.values - step)
        curvature = (second - 2.0 * error(found.problem.values)) / size**2
        np.testing.assert_allclose(information[k, k], curvature, rtol=2e-2)
