"""Good parameter values whose start states nobody knows are kept: a fit ends no worse than its start values."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.estimate.beginnings import cost_of, fits_of, tolerable, well_begun
from greybox_torch.estimate.descent import DescentOptions, descend, no_worse
from greybox_torch.estimate.fit import fit_records
from greybox_torch.estimate.free_run import simulate
from greybox_torch.estimate.levenberg_marquardt import DEFAULT
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.estimate.together.initial import well_begun_together
from greybox_torch.estimate.together.substeps import with_fine_steps
from greybox_torch.simulation.simulator import Simulator
from tests.estimate.test_descent import TRUTH, UNITS, Oscillation


class Anywhere(Oscillation):
    """Begins at a phase that is not known."""

    states = [gt.State("phase", "rad", initial=0.0)]


def recorded(phase: float) -> gt.DataSet:
    time = 0.01 * np.arange(3000)
    signals = {"torque": 0 * time, "position": 0.8 * np.sin(phase + 2.3 * time)}
    recording = gt.Recording.from_arrays("sine", signals, sample_time=0.01, role="estimation", units=UNITS)
    return gt.DataSet([recording], held_out_by_default=False)


def begun_with(phase: float, **values: float) -> Problem:
    """Recorded from another phase on than the model declares."""
    model, data = Anywhere(), recorded(phase)
    model.set_values(TRUTH | values)
    return make_problem(data, model, data.estimation())


def options_for(problem: Problem) -> DescentOptions:
    return DescentOptions(Simulator.of(problem.model, problem.free_names), DEFAULT)


@pytest.mark.parametrize("phase", [1.0, 2.0, 3.0])
def test_the_true_values_are_not_left_for_their_start_states(phase: float) -> None:
    """Seen: the diagnosis of a hoist with an elastic rope, whose load nobody had measured, was fitted to 50 times the error."""
    problem = begun_with(phase)
    as_given = simulate(problem, options_for(problem).simulator)
    assert not tolerable(fits_of(problem, as_given))
    stages: list[str] = []
    found = fit_records(problem, starts=1, progress=lambda stage, *_: stages.append(stage))
    assert set(stages) == {"whole records"}, "no windows, over which a good start is lost"
    assert found.problem.values == pytest.approx(list(TRUTH.values()), rel=1e-6)
    assert found.mse < 1e-12


def test_good_values_with_unknown_start_states_are_no_poor_start() -> None:
    """By default no other start values are looked for where these, well begun, lie near the optimum."""
    stages: list[str] = []
    fit_records(begun_with(2.0, frequency=2.301), progress=lambda stage, *_: stages.append(stage))
    assert set(stages) == {"whole records"}


def test_start_values_that_simulate_as_given_begin_there() -> None:
    problem = begun_with(0.0)
    own, cost = well_begun(problem, options_for(problem).simulator)
    assert own.initial == pytest.approx(problem.initial, abs=1e-6) and cost < 1e-12


def test_what_is_worse_than_the_start_values_is_given_up_for_where_these_lead() -> None:
    astray, problem = begun_with(2.0, frequency=0.3), begun_with(2.0)
    options = options_for(problem)
    own, cost = well_begun(problem, options.simulator)
    worse, best = descend(astray, options, 1), descend(problem, options, 1)
    assert worse is not None and best is not None
    assert worse.optimum.model.cost > cost > best.optimum.model.cost
    for found in (worse, None):
        kept = no_worse(found, own, cost, options)
        assert kept is not None and kept.optimum.point == pytest.approx(best.optimum.point, rel=1e-6)
    assert no_worse(best, own, cost, options) is best


def test_many_machines_begin_as_each_does_alone() -> None:
    model = Anywhere()
    model.set_values(TRUTH)
    data = [recorded(phase) for phase in (0.0, 0.5, 2.0)]
    problems = [make_problem(each, model, each.estimation()) for each in data]
    runs = with_fine_steps(problems, Simulator.of(model, problems[0].free_names))
    for problem, (own, cost) in zip(problems, well_begun_together(runs, range(3)), strict=True):
        alone, its_cost = well_begun(problem, options_for(problem).simulator)
        assert own.initial == pytest.approx(alone.initial, abs=1e-6)
        assert cost == pytest.approx(its_cost, abs=1e-9)
        assert cost <= cost_of(problem, options_for(problem).simulator)


def test_many_machines_keep_good_values_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where the descents of the batch lead astray."""
    import greybox_torch.estimate.together.descent as of_many

    true_way = of_many._whole_records

    def astray(runs: Any, begun: Any, options: Any) -> Any:
        poor = [begun_with(0.0, frequency=1.5) for _ in runs.problems]
        return true_way(with_fine_steps(poor, runs.simulator), begun, options)

    monkeypatch.setattr(of_many, "_whole_records", astray)
    model = Anywhere()
    model.set_values(TRUTH)
    for found in gt.fit_many(model, [recorded(0.3), recorded(2.0)], starts=1):
        assert isinstance(found, gt.FitResult)
        assert found.parameters["frequency"].value == pytest.approx(2.3, rel=1e-6)
