"""When simulations overflow, and what avoids it, on dx/dt = a x."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from greybox_torch.errors import NumericalError
from greybox_torch.estimate.fit import fit_records
from greybox_torch.estimate.free_run import simulate
from greybox_torch.estimate.overflow import NO_NUMBER, avoidance, overflow_error, overflows, suggestions
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.evaluation import evaluated
from greybox_torch.model import GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.simulator import Simulator


class Growth(GreyBoxModel):
    """dx/dt = a x + b u."""

    states = [State("speed", "rad/s", initial=1.0, fixed=True)]
    inputs = [Input("voltage", "V")]
    outputs = [Output("speed", "rad/s")]
    parameters = [Parameter("a", 400.0, unit="1/s", lower=-1e6), Parameter("b", 1.0)]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": p.a * x.speed + p.b * u.voltage}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": x.speed}


class Divided(Growth):
    """b dx/dt = -a x."""

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": -p.a * x.speed / p.b}


@pytest.fixture
def problem(data_set: Any) -> Problem:
    """Two experiments; the second is too short to overflow at 400 / s."""
    runs = [{"voltage": np.zeros(n), "speed": np.exp(-0.01 * np.arange(n))} for n in (500, 30)]
    data = data_set({"voltage": "V", "speed": "rad/s"}, runs)
    return make_problem(data, Growth(), data.recordings)


def test_where_and_when(problem: Problem) -> None:
    """One Runge-Kutta step of 10 ms multiplies by 1 + 4 + 8 + 64/6 + 256/24 = 34.33."""
    simulator = Simulator.of(problem.model, problem.free_names)
    (found,) = overflows(problem, simulate(problem, simulator))
    beyond = int(np.ceil(np.log(np.finfo(float).max) / 2.0 / np.log(34.0 + 1 / 3)))  # where the square is no number
    assert found.experiment == "run 1"
    assert beyond - 4 <= found.sample <= beyond  # the slopes within a step overflow a little before the state does
    assert found.time == pytest.approx(0.01 * found.sample)
    assert overflows(problem, [np.zeros((500, 1)), np.zeros((30, 1))]) == ()


def test_start_values_that_avoid_it(problem: Problem) -> None:
    simulator = Simulator.of(problem.model, problem.free_names)
    (found,) = suggestions(problem, simulator)
    assert (found.name, found.before, found.unit) == ("a", 400.0, "1/s")
    assert found.value < 200.0
    there = problem.with_values(np.array([found.value, 1.0]))
    assert overflows(there, simulate(there, simulator)) == ()
    assert str(found) == f"a = {found.value:g} 1/s (now 400)"


def test_none_avoids_it(problem: Problem) -> None:
    held = problem.with_values(np.array([4e6, 1.0]))
    held = make_narrow(held)
    assert suggestions(held, Simulator.of(problem.model, problem.free_names)) == ()
    assert "check units, scales and signs" in avoidance(())


def test_a_parameter_of_zero_is_tried_with_the_models_own_value(problem: Problem) -> None:
    """Seen: a heat capacity of 0 on the card: "changing one parameter alone, by up to 1000 times, does not avoid it"."""
    divided = replace(problem, model=Divided(), values=np.array([0.0, 0.0]))
    (found,) = suggestions(divided, Simulator.of(divided.model, divided.free_names))
    assert str(found) == "b = 1 (now 0)"


class DividedTwice(Growth):
    """max(b, c) dx/dt = -a x."""

    parameters = [Parameter("a", 400.0, unit="1/s"), Parameter("b", 1.0), Parameter("c", 1.0)]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": -p.a * x.speed / torch.maximum(p.b, p.c)}


def test_a_parameter_that_is_fixed_at_zero_is_tried_last(data_set: Any, problem: Problem) -> None:
    """Seen: a friction that was fixed at 0 on purpose was proposed as 1."""
    data = data_set({"voltage": "V", "speed": "rad/s"}, [{"voltage": np.zeros(30), "speed": np.zeros(30)}])
    own = make_problem(data, DividedTwice(), data.recordings).with_values(np.zeros(3))
    simulator = Simulator.of(own.model, own.free_names)
    assert [s.name for s in suggestions(own, simulator)] == ["b", "c"]
    for fixed, proposed in (("b", ["c"]), ("c", ["b"])):
        held = replace(own, free=np.array([name != fixed for name in own.names]))
        assert [s.name for s in suggestions(held, simulator)] == proposed
    held = replace(own, free=np.array([name == "a" for name in own.names]))
    assert [s.name for s in suggestions(held, simulator)] == ["b", "c"], "no free one avoids it"


def make_narrow(problem: Problem) -> Problem:
    return replace(problem, lower=np.array([1e6, 0.5]), upper=np.array([1e7, 2.0]))


def test_the_error_says_all_of_it(problem: Problem) -> None:
    simulator = Simulator.of(problem.model, problem.free_names)
    message = str(overflow_error("simulating", problem, simulator))
    assert message.startswith("simulating Growth: failed: the simulation overflows at the start values (at t = ")
    assert " s in 'run 1'; it does not with a = " in message
    assert message.endswith("try start values nearer to the truth, tighter bounds, or a smaller sample time")


def test_fit_of_what_cannot_be_simulated(problem: Problem) -> None:
    with pytest.raises(NumericalError, match=r"estimating Growth: failed: .* in 'run 1'"):
        fit_records(make_narrow(problem.with_values(np.array([4e6, 1.0]))))


class Orifice(GreyBoxModel):
    """A volume that fills through an orifice from a supply, up to where the root is of a negative number."""

    states, inputs, outputs = [State("p", "bar")], [Input("v", "")], [Output("p", "bar")]
    parameters = [Parameter("k", 1.0, unit="1/s")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"p": p.k * u.v * (0.1 + torch.sqrt(1.0 - x.p))}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"p": x.p}


def test_the_root_of_a_negative_number_is_told_from_growth(data_set: Any, problem: Problem) -> None:
    """Seen: "overflows at 0.854 s … it does not with Kq = 2e-09" of a root of a negative number."""
    data = data_set({"v": "", "p": "bar"}, [{"v": [1.0] * 400, "p": [0.5] * 400}])
    own = make_problem(data, Orifice(), data.recordings)
    message = str(overflow_error("simulating", own, Simulator.of(own.model, own.free_names)))
    assert NO_NUMBER in message
    assert NO_NUMBER not in str(overflow_error("simulating", problem, Simulator.of(problem.model, problem.free_names)))
    assert NO_NUMBER in (evaluated(data, Orifice()).overflow or "")
