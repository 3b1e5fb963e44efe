from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.estimate.metrics import (
    digits_between,
    final_prediction_error,
    fit_percent,
    root_mean_square,
    told_fit,
)

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
        ([0.263] * 1250, [0.264] * 1250, -INF, 0.001),  # whose mean is not 0.263: a fit of -1e13 %
    ],
)
def test_figures(measured: list[float], simulated: list[float], fit: float, rms: float) -> None:
    y, s = np.array(measured), np.array(simulated)
    assert fit_percent(y, s) == pytest.approx(fit)
    assert root_mean_square(y, s) == pytest.approx(rms)


@pytest.mark.parametrize(("unknowns", "expected"), [(0, 2.0), (5, 6.0), (10, INF), (12, INF)])
def test_final_prediction_error_of_ten_samples(unknowns: int, expected: float) -> None:
    """Seen: a division by zero with as many unknowns as samples, and a negative error with more of them."""
    assert final_prediction_error(2.0, unknowns, 10) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("before", "after", "digits"),
    [
        (73.5, 98.7, 1),
        (99.94, 99.991, 1),
        (99.96, 99.99, 2),
        (99.9621, 99.9623, 4),
        (99.0, 99.0, 1),
        (100 - 1e-9, 100.0, 4),
    ],
)
def test_two_fits_are_told_with_the_decimals_that_show_how_they_differ(
    before: float, after: float, digits: int
) -> None:
    """Seen: "the validation fit goes from 100.0 % to 100.0 %"."""
    assert digits_between(before, after) == digits


def test_how_far_a_run_away_model_came_is_no_number() -> None:
    assert [told_fit(value, 1) for value in (-798262.4, -np.inf, -999.9, 71.64)] == [
        "below -1000 %",
        "below -1000 %",
        "-999.9 %",
        "71.6 %",
    ]
