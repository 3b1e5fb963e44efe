"""Windows of which late outputs leave nothing to compare fit anything, and count as none."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from greybox_torch.estimate.compared import compared
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.window_fit import evaluate
from greybox_torch.model import GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import cut

STEP, LENGTH = 0.01, 20


class Late(GreyBoxModel):
    """dx/dt = u − decay x, whose output tells nothing of the first ``unknown`` seconds of every window of 20 samples."""

    states = [State("speed", "rad/s", initial="measured")]
    inputs = [Input("voltage", "V")]
    outputs = [Output("speed", "rad/s")]
    parameters = [Parameter("decay", 1.0, lower=0.0), Parameter("unknown", 0.0, lower=0.0)]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": u.voltage - p.decay * x.speed}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": x.speed}

    def settled(self, records: Any, values: Any) -> Any:
        hidden = np.arange(records.y.shape[1]) % LENGTH < values[1] / STEP - 0.5
        return replace(records, y=np.where(hidden, np.nan, records.y))


def late(data_set: Any, unknown: float) -> tuple[Any, Any, Any]:
    """A problem whose outputs come ``unknown`` samples late, its simulator, and its windows."""
    speed = np.sin(0.3 * np.arange(200))
    dataset = data_set(
        {"voltage": "V", "speed": "rad/s"}, [{"voltage": np.ones(200), "speed": speed}], sample_time=STEP
    )
    problem = make_problem(dataset, Late(), dataset.estimation())
    problem = replace(problem, values=np.array([1.0, unknown * STEP]))
    return problem, Simulator.of(problem.model, problem.free_names), cut(problem.records, LENGTH)


def test_what_windows_compare(data_set) -> None:
    problem, _, windows = late(data_set, 5)
    assert compared(problem.records, windows) == 200
    assert compared(problem.window_records, windows) == 200 - 5 * len(windows.start)


def test_a_window_that_is_compared_with_nothing_is_no_fit(data_set) -> None:
    """Seen: a dead time of 500 samples over windows of 20 to 380: no error at all, and "100 % explained"."""
    for unknown, told in ((0, True), (10, True), (15, False), (LENGTH, False)):
        problem, simulator, windows = late(data_set, unknown)
        states = np.zeros((len(windows.start), 1))
        assert (evaluate(problem, simulator, windows, states) is not None) is told


def test_outputs_that_are_seldom_measured_may_be_late(data_set) -> None:
    """Seen: a position in every twentieth row, 0.2 s late: no fit of a dead time, and two lags told instead (0.97)."""
    problem, simulator, windows = late(data_set, 1)
    seldom = np.where(np.arange(200) % LENGTH == 7, problem.records.y, np.nan)
    problem = replace(problem, records=replace(problem.records, y=seldom))
    assert evaluate(problem, simulator, windows, np.zeros((len(windows.start), 1))) is not None
