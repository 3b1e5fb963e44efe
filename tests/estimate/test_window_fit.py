"""Fits on windows with free start states: where they end, and that bounds do not stop the other unknowns."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greybox_torch.estimate.levenberg_marquardt import Settings
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.estimate.rival import Rival
from greybox_torch.estimate.window_fit import WindowFit, _exceeds, _weak_hold, evaluate, fit_windows
from greybox_torch.estimate.window_step import held
from greybox_torch.model import GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import cut

UNITS = {"voltage": "V", "speed": "rad/s"}
TIGHT = Settings(iterations=60, tolerance=1e-12, trials=10)


class TwoGains(GreyBoxModel):
    """dx/dt = gain u + extra u³ − decay x."""

    states = [State("speed", "rad/s", initial="measured")]
    inputs = [Input("voltage", "V")]
    outputs = [Output("speed", "rad/s")]
    parameters = [
        Parameter("gain", 1.0, lower=0.0),
        Parameter("extra", 0.5, lower=0.0),
        Parameter("decay", 1.0, lower=0.0),
    ]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": p.gain * u.voltage + p.extra * u.voltage**3 - p.decay * x.speed}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": x.speed}


def recordings(data_set: Any, extra: float) -> Any:
    """Steps of random height, simulated exactly: dx/dt = 2 u + extra u³ − 3 x, a little noise."""
    draw = np.random.default_rng(4)
    voltage = np.repeat(draw.uniform(-2, 2, 40), 25)
    speed, decayed = np.zeros(1000), np.exp(-3.0 * 0.01)
    for k in range(999):
        level = (2.0 * voltage[k] + extra * voltage[k] ** 3) / 3.0
        speed[k + 1] = level + (speed[k] - level) * decayed
    return data_set(UNITS, [{"voltage": voltage, "speed": speed + 0.001 * draw.normal(size=1000)}])


def recorded(data_set: Any, extra: float) -> Problem:
    data = recordings(data_set, extra)
    return make_problem(data, TwoGains(), data.estimation())


def fitted(problem: Problem) -> WindowFit:
    """Fitted three times over: each fit holds the start states, weakly, where it began."""
    simulator = Simulator.of(problem.model, problem.free_names)
    found = None
    for _ in range(3):
        found = fit_windows(problem, simulator, 100, settings=TIGHT)
        assert found is not None
        problem = found.problem
    assert found is not None
    return found


def test_finds_the_truth(data_set: Any) -> None:
    assert fitted(recorded(data_set, 0.7)).problem.values == pytest.approx([2.0, 0.7, 3.0], rel=2e-3)


def test_with_an_unknown_at_its_bound_the_others_reach_their_optimum(data_set: Any) -> None:
    """The cubic gain wants to be negative; the rest must do as well as where it is not there at all, in a few steps."""
    problem = recorded(data_set, -0.2)
    bounded = fitted(problem)
    without = problem.with_values(np.array([1.0, 0.0, 1.0]))
    free = np.array([True, False, True])
    alone = fitted(Problem(**{**without.__dict__, "free": free}))
    assert bounded.problem.values[1] == 0.0
    assert bounded.mean_square == pytest.approx(alone.mean_square, rel=1e-4)
    assert bounded.problem.values == pytest.approx(alone.problem.values, rel=5e-3, abs=1e-12)
    assert bounded.evaluations < 30


def test_a_fit_far_behind_its_rival_is_given_up(data_set: Any) -> None:
    problem = recorded(data_set, 0.7)
    simulator = Simulator.of(problem.model, problem.free_names)
    plain = fit_windows(problem, simulator, 100, settings=TIGHT)
    beside_worse = fit_windows(problem, simulator, 100, settings=TIGHT, rival=Rival(1e6, 1.0))
    beside_better = fit_windows(problem, simulator, 100, settings=TIGHT, rival=Rival(1e-30, 1.0))
    assert plain is not None
    assert beside_worse is not None
    assert beside_better is not None
    assert beside_worse.mean_square == plain.mean_square
    assert beside_better.evaluations < plain.evaluations


class WithSpare(TwoGains):
    """One parameter more, on which nothing depends."""

    parameters = [*TwoGains.declared_parameters, Parameter("spare", 1.0, lower=0.0)]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": super().derivative(x, u, p, port)["speed"] + 0.0 * p.spare}


def test_what_the_recordings_do_not_determine_returns_to_what_was_expected(data_set: Any) -> None:
    known = recorded(data_set, 0.7)
    data = data_set(UNITS, [{"voltage": known.records.u[0], "speed": known.records.y[0]}])
    problem = make_problem(data, WithSpare(), data.estimation())
    found = fitted(problem.with_values(np.array([2.0, 0.7, 3.0, 50.0])))
    assert found.problem.values == pytest.approx([2.0, 0.7, 3.0, 1.0], rel=5e-3)


def pushed(width: float, pressure: float) -> GreyBoxModel:
    """dx/dt = gain u + extra (u / width)³ − decay x + P / pressure; what no sensor shows, P, falls by itself."""

    class Pushed(TwoGains):
        states = [*TwoGains.states, State("pressure", initial=0.0)]
        parameters = [
            Parameter("gain", 1.0, lower=0.0),
            Parameter("extra", 0.0),
            Parameter("decay", 1.0, lower=0.0),
            Parameter("fall", 2.0, lower=0.1),
        ]

        def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
            speed = p.gain * u.voltage + p.extra * (u.voltage / width) ** 3 - p.decay * x.speed
            return {"speed": speed + x.pressure / pressure, "pressure": -p.fall * x.pressure}

    return Pushed()


@pytest.mark.parametrize(("width", "pressure"), [(2.0**20, 1.0), (2.0**-20, 1.0), (1.0, 2.0**40), (2.0**14, 2.0**-40)])
def test_a_fit_is_the_same_in_any_units(data_set: Any, width: float, pressure: float) -> None:
    """What the cube of a small deflection, or a pressure in Pa, does to the outputs is tiny beside what others do."""

    def at(width: float, pressure: float) -> WindowFit:
        data, model = recordings(data_set, 0.7), pushed(width, pressure)
        problem = make_problem(data, model, data.estimation())
        begun = np.random.default_rng(0).normal(size=(len(cut(problem.records, 100).start), 2)) * [1.0, pressure]
        found = None
        for _ in range(3):
            simulator = Simulator.of(model, problem.free_names)
            found = fit_windows(problem, simulator, 100, settings=TIGHT, starts=begun)
            assert found is not None
            problem, begun = found.problem, found.starts
        assert found is not None
        return found

    own, other = at(1.0, 1.0), at(width, pressure)
    assert other.mean_square == pytest.approx(own.mean_square, rel=1e-6)
    assert other.problem.values / [1.0, width**3, 1.0, 1.0] == pytest.approx(own.problem.values, rel=1e-4)


def test_a_pass_without_tangents_tells_the_same_cost(data_set: Any) -> None:
    """After a rejected step the next is judged by its cost alone: it has to be that of a pass with tangents."""
    problem = recorded(data_set, 0.5)
    simulator, windows = Simulator.of(problem.model, problem.free_names), cut(problem.records, 100)
    draw = np.random.default_rng(6)
    begun = draw.normal(size=(len(windows.start), 1))
    hold = _weak_hold(problem, begun, 0.1, windows.steps, None)
    for _ in range(5):
        there = problem.with_values(draw.uniform(0.5, 3.0, 3))
        states = begun + draw.normal(size=begun.shape)
        passed = evaluate(there, simulator, windows, states)
        assert passed is not None
        found = held(passed, hold)
        assert not _exceeds(found.cost * (1 + 1e-9), there, simulator, windows, states, hold)
        assert _exceeds(found.cost * (1 - 1e-9), there, simulator, windows, states, hold)
    assert _exceeds(np.inf, problem, simulator, windows, np.full_like(begun, np.inf), hold), "it overflows"


def test_a_fit_is_carried_on_from_the_pass_that_it_ended_with(data_set: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """The pass at its own starts, by the simulator that it was made with, is not simulated again, and the result is the same."""
    problem = recorded(data_set, 0.5)
    simulator, other = (Simulator.of(problem.model, problem.free_names) for _ in range(2))
    first = fit_windows(problem, simulator, 100, settings=Settings(iterations=2))
    assert first is not None
    known = first.known(simulator, first.starts)
    assert known is not None and known.mean_square == first.mean_square
    assert first.known(other, first.starts) is None and first.known(simulator, first.starts.copy()) is None
    on = {"starts": first.starts, "damping": first.damping, "carried": True}
    again, anew = (fit_windows(first.problem, simulator, 100, **on, known=k) for k in (known, None))
    assert again is not None and anew is not None and again.evaluations == anew.evaluations - 1
    assert (again.problem.values == anew.problem.values).all() and (again.starts == anew.starts).all()
