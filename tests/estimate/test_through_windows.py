"""Whole records descended on from what windows lead to, and start states that a model file holds."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.estimate.beginnings import fits_of
from greybox_torch.estimate.descent import Descent, DescentOptions, or_elsewhere
from greybox_torch.estimate.free_run import FreeRun, simulate
from greybox_torch.estimate.held_starts import held_starts
from greybox_torch.estimate.levenberg_marquardt import DEFAULT, minimise
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.through_windows import from_windows, through_windows
from greybox_torch.simulation.simulator import Simulator

UNITS = {"push": "N", "position": "m"}
TIME = 0.01 * np.arange(2000)
STIFFNESS = 25.0


class Oscillator(gt.GreyBoxModel):
    """A mass of 1 kg on a spring, begun at rest by its file."""

    states = [gt.State("position", "m", initial="measured"), gt.State("speed", "m/s", initial=0.0, fixed=True)]
    inputs = [gt.Input("push", "N")]
    outputs = [gt.Output("position", "m")]
    parameters = [gt.Parameter("k", 20.0, unit="N/m", lower=0.0)]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"position": x.speed, "speed": u.push - p.k * x.position}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"position": x.position}


def recorded(data_set: Any, speed: float, **card: Any) -> gt.DataSet:
    """The free oscillation by its formula, from 0.1 m and a start speed."""
    rate = np.sqrt(STIFFNESS)
    position = 0.1 * np.cos(rate * TIME) + speed / rate * np.sin(rate * TIME)
    return data_set(UNITS, [{"push": 0.0 * TIME, "position": position}], **card)


def caught(problem: Any, simulator: Simulator) -> Descent:
    """A descent that stopped where it began."""
    run = FreeRun(problem, simulator)
    optimum = minimise(run.quadratic, run.start, *run.bounds, settings=replace(DEFAULT, iterations=0))
    assert optimum is not None
    return Descent(run, optimum, 1)


@pytest.mark.parametrize("starts", [None, 1])
def test_whole_records_are_asked_again_from_what_windows_lead_to(data_set: Any, starts: int | None) -> None:
    data = recorded(data_set, 0.0)
    problem = make_problem(data, Oscillator(), data.estimation())
    simulator = Simulator.of(problem.model, problem.free_names)
    found = caught(problem, simulator)
    close = np.array([96.0])  # so good that no other start values would be drawn
    assert fits_of(problem, simulate(problem, simulator)).min() < 50.0
    nearer = or_elsewhere(problem, close, found, DescentOptions(simulator, DEFAULT), starts)
    assert nearer is not None
    if starts == 1:
        assert nearer is found, "one start value, as given, and nothing else"
    else:
        assert nearer.run.at(nearer.optimum.point).values[0] == pytest.approx(STIFFNESS, rel=1e-4)


def test_windows_of_growing_length_tell_their_error(data_set: Any) -> None:
    data = recorded(data_set, 0.0)
    problem = make_problem(data, Oscillator(), data.estimation())
    told: list[tuple[str, int]] = []
    fits = list(
        through_windows(
            problem, Simulator.of(problem.model, problem.free_names), lambda stage, n, error: told.append((stage, n))
        )
    )
    assert [f.windows.steps for f in fits] == [31, 125]
    assert [stage for stage, _ in told] == ["windows of 31 samples", "windows of 125 samples"]
    assert told[1][1] == sum(f.evaluations for f in fits)
    begun = from_windows(fits[-1])
    assert begun.initial[0, 1] == 0.0, "what the model file holds stays"
    assert begun.initial[0, 0] == pytest.approx(0.1, abs=1e-3)


@pytest.mark.parametrize("speed", [-0.6, 0.6])
def test_start_states_that_a_model_holds_and_a_recording_does_not_begin_with_are_told(
    data_set: Any, speed: float
) -> None:
    found = gt.fit(Oscillator(), recorded(data_set, speed))
    assert found.held is not None and found.held.states == ("speed",)
    assert found.held.left < 0.01
    told = repr(found._advice)
    assert "begins speed at 0 m/s, and holds it there" in told and "[model.initial] speed = { fixed = false }" in told


def test_nothing_is_told_of_start_states_that_are_right_or_that_the_card_mentions(data_set: Any) -> None:
    assert gt.fit(Oscillator(), recorded(data_set, 0.0)).held is None
    by_card = recorded(data_set, 0.6, initial={"speed": {"value": 0.0, "fixed": True}})
    assert gt.fit(Oscillator(), by_card).held is None, "the user has said so"
    freed = gt.fit(Oscillator(), recorded(data_set, 0.6, initial={"speed": {"fixed": False}}))
    assert freed.held is None and freed.parameters["k"].value == pytest.approx(STIFFNESS, rel=1e-4)


def test_of_a_model_that_windows_follow_no_better_nothing_is_asked(data_set: Any) -> None:
    data = recorded(data_set, 0.6)
    problem = make_problem(data, Oscillator(), data.estimation())
    assert held_starts(data, problem, 1e-12, Simulator.of(problem.model, problem.free_names)) is None
