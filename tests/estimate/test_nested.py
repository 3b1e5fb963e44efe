"""A richer model never ends worse than the simpler one that it holds."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.estimate import nested
from greybox_torch.estimate.descent import DescentOptions, descend
from greybox_torch.estimate.fit import fit_records
from greybox_torch.estimate.global_search import look_around
from greybox_torch.estimate.levenberg_marquardt import DEFAULT
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.simulation.simulator import Simulator


class Rippled(gt.GreyBoxModel):
    """J dw/dt = k v - b w - r sin(3 q), a ripple that begins at zero."""

    states = [gt.State("angle", "rad"), gt.State("speed", "rad/s", initial="measured")]
    inputs, outputs = [gt.Input("voltage", "V")], [gt.Output("speed", "rad/s")]
    parameters = [
        gt.Parameter("J", 0.04, unit="kg m^2", lower=1e-4),
        gt.Parameter("b", 0.1, unit="N m s/rad", lower=0.0),
        gt.Parameter("r", 0.0, unit="N m", lower=-1.0, upper=1.0),
    ]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"angle": x.speed, "speed": (0.1 * u.voltage - p.b * x.speed - p.r * (3.0 * x.angle).sin()) / p.J}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": x.speed}


@pytest.fixture(scope="module")
def problem(motor_speed) -> Problem:
    draw = np.random.default_rng(3)
    voltage = np.repeat(draw.uniform(-3, 3, 15), 20)
    speed = motor_speed(voltage) + draw.normal(0, 0.02, len(voltage))
    signals = {"voltage": voltage, "speed": speed}
    data = gt.DataSet([gt.Recording.from_arrays("steps", signals, sample_time=0.01)], held_out_by_default=False)
    return make_problem(data, Rippled(), data.estimation())


def held(problem: Problem) -> Problem:
    return replace(problem, free=np.isin(problem.names, ["J", "b"]))


def test_a_descent_that_ends_in_a_worse_valley_is_replaced(problem: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    """The descent of the richer model is led astray, as it is on machines with many valleys."""
    simpler = fit_records(held(problem), starts=1)

    def astray(begin: Problem, options: Any, starts: int | None) -> Any:
        if begin.free.all():
            begin = begin.with_values(np.array([0.5, 0.01, 0.9]))
            options = replace(options, settings=replace(options.settings, iterations=1))
        return descend(begin, options, starts)

    monkeypatch.setattr(nested, "descend", astray)
    found = fit_records(problem, starts=1)
    assert found.problem.free.all()
    assert found.mse <= simpler.mse * (1 + 1e-9)
    assert found.problem.values[0] == pytest.approx(0.02, rel=0.05)
    assert found.evaluations > simpler.evaluations


def test_what_is_better_already_stays(problem: Problem) -> None:
    found = fit_records(problem, starts=1)
    assert found.mse <= fit_records(held(problem), starts=1).mse
    assert abs(found.problem.values[2]) < 0.01


def test_nothing_is_held_where_nothing_begins_at_zero(problem: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[Problem] = []

    def counted(begin: Problem, options: Any, starts: int | None) -> Any:
        seen.append(begin)
        return descend(begin, options, starts)

    monkeypatch.setattr(nested, "descend", counted)
    fit_records(held(problem), starts=1)
    assert len(seen) == 1
    told: list[str] = []
    fit_records(problem, starts=1, progress=lambda stage, k, error: told.append(stage))
    assert [int(p.free.sum()) for p in seen] == [2, 3, 2]
    assert any(stage.startswith("with r held at zero: whole records") for stage in told)


def test_the_simpler_model_is_told_what_it_has_to_beat(problem: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    """Seen: half of the time of an arm from poor start values went into other valleys of the model without its cubic stiffness."""
    told: list[float] = []

    def asked(begin: Problem, options: Any, starts: int | None) -> Any:
        told.append(options.to_beat)
        return descend(begin, options, starts)

    monkeypatch.setattr(nested, "descend", asked)
    found = fit_records(problem, starts=1)
    assert told == [float("inf"), pytest.approx(found.mse, rel=1e-6)]


@pytest.mark.parametrize(("share", "given_up"), [(0.5, True), (2.0, False)])
def test_a_search_that_is_clearly_behind_is_given_up(problem: Problem, share: float, given_up: bool) -> None:
    simulator, best = Simulator.of(problem.model, problem.free_names), fit_records(problem, starts=1).mse
    found = look_around(problem, simulator, starts=8, to_beat=share * best)
    assert (found is None) is given_up


def test_options_used_twice_number_the_descents_anew(problem: Problem) -> None:
    """Seen by reading: the descents of a second estimation went on from the number of the last of the first."""
    told: list[str] = []
    options = DescentOptions(
        Simulator.of(problem.model, problem.free_names), DEFAULT, lambda stage, k, error: told.append(stage)
    )
    nested.descend_nested(problem, options, 1)
    first, told[:] = told.copy(), []
    nested.descend_nested(problem, options, 1)
    assert "whole records" in first and told == first
