"""A parameter that nothing depends on is put back to where it began."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, ClassVar

import pytest

from greybox_torch.estimate.descent import Descent
from greybox_torch.estimate.fit import estimation_of
from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.identifiability import Unidentifiable
from greybox_torch.estimate.levenberg_marquardt import Optimum
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.termination import Termination
from greybox_torch.model import GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.simulator import SimulationOptions, Simulator

LOST = 1e20
"""Where rounding errors led it."""


class Unused(GreyBoxModel):
    states: ClassVar = [State("speed", "rad/s", initial="measured")]
    inputs: ClassVar = [Input("voltage", "V")]
    outputs: ClassVar = [Output("speed", "rad/s")]
    parameters: ClassVar = [Parameter("a", 2.0), Parameter("unused", 3.0)]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": p.a * u.voltage - 5.0 * x.speed}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": x.speed}


class Constrained(Unused):
    def admissible(self, p: Any) -> dict[str, Any]:
        return {"four - a + unused": 4.0 - p.a + p.unused}


class Acting(Unused):
    """Of a gain that is nothing where the parameter is as it began."""

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": p.a * p.unused / LOST * u.voltage - 5.0 * x.speed}


@pytest.fixture
def left_at(experiments: list[Any], data_set: Any) -> Any:
    """Where the parameter is left by an estimation with the gain at its optimum, whose own run had that cost times a factor."""

    def left(model: GreyBoxModel, precision: str = "double", gain: float = 8.0, learned: float = 1.0) -> float:
        data = data_set({"voltage": "V", "speed": "rad/s"}, experiments)
        problem = make_problem(data, model, data.estimation())
        options = SimulationOptions(precision=precision)
        run = FreeRun(problem, Simulator.of(problem.model, problem.free_names, options))
        point = run.start.copy()
        point[:2] = gain, LOST
        here = run.quadratic(point)
        assert here is not None
        optimum = Optimum(point, replace(here, cost=learned * here.cost), 1, 1, Termination.small_step)
        unmoved = Unidentifiable("unmoved", ("unused",), (1.0,), "")
        return estimation_of(Descent(run, optimum, 1), problem.samples, False, (unmoved,)).problem.values[1]

    return left


@pytest.mark.parametrize("precision", ["double", "single"])
def test_it_is_put_back_though_what_a_run_has_learned_rounds_in_another_way(left_at: Any, precision: str) -> None:
    """Seen by reading: the cost there was compared with one of a run that had learned where its windows start."""
    assert left_at(Unused(), precision, learned=1.0 - 1e-6) == 3.0


def test_it_stays_where_putting_it_back_breaks_a_constraint(left_at: Any) -> None:
    assert left_at(Constrained(), gain=8.0) == LOST
    assert left_at(Constrained(), gain=6.0) == 3.0


def test_it_stays_where_it_acts_there(left_at: Any) -> None:
    assert left_at(Acting()) == LOST
