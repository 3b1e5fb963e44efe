"""The figure of a comparison: which stretch it shows in detail, and what it says of it."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

from greybox_torch.data import Channel, Recording
from greybox_torch.report.comparison import plot_comparison

TIME = 0.01 * np.arange(1000)
MEASURED = np.sin(TIME)


def detail(**simulated: np.ndarray) -> tuple[str, float, float]:
    """What is said of the detail, and from when to when it is."""
    run = Recording.from_arrays("Run", {"speed": MEASURED}, sample_time=0.01, role="validation")
    outputs = {name: values[:, None] for name, values in simulated.items()}
    figure = plot_comparison(run, [Channel("speed", "rad/s")], outputs, {name: name for name in outputs})
    titled = next(axes for axes in figure.axes if axes.get_title().startswith("where"))
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


def drawn(**simulated: np.ndarray) -> Figure:
    run = Recording.from_arrays("Run", {"speed": MEASURED}, sample_time=0.01, role="validation")
    outputs = {name: values[:, None] for name, values in simulated.items()}
    legend = {name: f"{name} (12.3 %, 45.6 %)" for name in outputs}
    return plot_comparison(run, [Channel("speed", "rad/s")], outputs, legend)


def test_a_model_that_is_far_off_leaves_the_axes_of_the_others() -> None:
    """Seen: a start model at -1218 % set all scales, so that the two models of interest and their errors were lines."""
    near = {"fit": bump(2.0), "diagnosed": MEASURED + 0.01 * np.cos(TIME)}
    figure = drawn(start=MEASURED - 3.0 * TIME, **near)
    assert all(high - low < 3.5 for low, high in (axes.get_ylim() for axes in figure.axes))
    assert figure.axes[0].get_title() == "start leaves the axes"
    away = {"fit": near["fit"], "start": MEASURED - 3.0 * TIME}
    told, begin, end = detail(**away)
    assert told == "where the error of fit is largest" and begin < 2.0 < end, (
        "seen: of start, beyond axes kept to the other"
    )
    assert drawn(**away).axes[0].get_title() == "start leaves the axes"
    plain = drawn(**near)
    assert not plain.axes[0].get_title() and plain.axes[1].get_ylim()[0] < -1.0
    low, _ = drawn(start=MEASURED - 3.0 * TIME).axes[0].get_ylim()
    assert low < -25.0, "the only one is drawn altogether"


def test_titles_stand_within_the_figure() -> None:
    """Seen: "where the error of out_diag/model (53.9 %, 53.9 %) is larges"."""
    name = "results of the second week/with the new sensor/line 3/model"
    figure = drawn(**{"start": bump(2.0), name: bump(7.0)})
    figure.draw_without_rendering()
    titles = [axes.title.get_window_extent() for axes in figure.axes if axes.get_title()]
    assert titles and all(box.x1 <= figure.bbox.x1 and box.x0 >= 0.0 for box in titles)
    assert "%" not in " ".join(axes.get_title() for axes in figure.axes)
