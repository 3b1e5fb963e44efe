"""The figure of a comparison: which stretch it shows in detail, and what it says of it."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.data import Channel, Recording
from greybox_torch.report.comparison import plot_comparison

TIME = 0.01 * np.arange(1000)
MEASURED = np.sin(TIME)


def detail(**simulated: np.ndarray) -> tuple[str, float, float]:
    """What is said of the detail, and from when to when it is."""
    run = Recording.from_arrays("Run", {"speed": MEASURED}, sample_time=0.01, role="validation")
    outputs = {name: values[:, None] for name, values in simulated.items()}
    figure = plot_comparison(run, [Channel("speed", "rad/s")], outputs, {name: name for name in outputs})
    titled = next(axes for axes in figure.axes if axes.get_title())
    shown = np.asarray(titled.lines[0].get_xdata(), dtype=float)
    return titled.get_title(), shown[0], shown[-1]


def bump(at: float) -> np.ndarray:
    return MEASURED + np.exp(-((TIME - at) ** 2) / 0.02)


def test_of_several_models_it_says_whose_error_is_largest_there() -> None:
    """Seen: "where the error is largest", that of the last model, the others worse elsewhere."""
    told, begin, end = detail(start=bump(2.0), fit=bump(7.0))
    assert told == "where the error of fit is largest" and begin < 7.0 < end
    assert detail(start=bump(2.0))[0] == "where the error is largest"


@pytest.mark.parametrize("growth", [20.0, 200.0])
def test_where_a_simulation_runs_away_the_detail_is_its_last_stretch(growth: float) -> None:
    """Seen: the detail ended seconds before an error that grew to 1e102."""
    away = MEASURED + np.exp(np.minimum(growth * (TIME - 6.0), 500.0))
    left = float(TIME[np.argmax(np.abs(away - MEASURED.mean()) > 100.0 * np.ptp(MEASURED))])
    told, begin, end = detail(start=away)
    assert told == "where the simulation runs away" and begin < left < end
