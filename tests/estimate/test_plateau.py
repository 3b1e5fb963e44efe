"""Places where part of a model has no effect, and the way off them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

from greybox_torch.estimate.fit import fit_records
from greybox_torch.estimate.free_run import FreeRun, simulate
from greybox_torch.estimate.global_search import WIDE_SPREAD, _drawn
from greybox_torch.estimate.levenberg_marquardt import Settings, answered
from greybox_torch.estimate.logarithmic import descending_on_logarithms
from greybox_torch.estimate.logarithmic_members import LogarithmicMembers
from greybox_torch.estimate.plateau import idle_at, off_the_plateau
from greybox_torch.estimate.population import Members, Population, improve
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.model import GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.simulator import Simulator

TRUTH = np.array([0.1, 0.3, 1.2, 6.0, 20.0])
NOISE = 0.02
SETTINGS = Settings(iterations=60)


class Sticking(GreyBoxModel):
    """A body with viscous friction and more of it near standstill; where that is flat, its level and steepness act as viscous friction."""

    states = [State("speed", "rad/s", initial=0.0, fixed=True)]
    inputs, outputs = [Input("torque", "N m")], [Output("speed", "rad/s")]
    parameters = [
        Parameter("inertia", 0.1, unit="kg m^2", lower=1e-3),
        Parameter("viscous", 0.3, unit="N m s/rad", lower=0.0),
        Parameter("level", 1.0, unit="N m", lower=0.0),
        Parameter("decay", 1.0, unit="s/rad", lower=0.0),
        Parameter("steepness", 1.0, unit="s/rad", lower=0.0),
    ]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        sticking = p.level / (p.decay * x.speed).clamp(-80.0, 80.0).cosh() * (p.steepness * x.speed).tanh()
        return {"speed": (u.torque - p.viscous * x.speed - sticking) / p.inertia}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": x.speed}


@pytest.fixture
def problem(data_set: Callable[..., Any]) -> Problem:
    rng, time = np.random.default_rng(3), 0.01 * np.arange(2000)
    torque = 2.0 * np.sin(1.3 * time) + np.sin(3.1 * time + 1.0) + 0.5 * np.repeat(rng.uniform(-1, 1, 40), 50)

    def measured(speed: np.ndarray) -> Problem:
        data = data_set({"torque": "N m", "speed": "rad/s"}, [{"torque": torque, "speed": speed}])
        return make_problem(data, Sticking(), data.estimation())

    true = measured(0.0 * time).with_values(TRUTH)
    speed = simulate(true, Simulator.of(true.model, ()).with_substeps(8))[0][:, 0]
    return measured(speed + rng.normal(0.0, NOISE, len(time)))


@pytest.fixture
def members(problem: Problem) -> Members:
    return Members(problem, problem.records, Simulator.of(problem.model, problem.free_names).with_substeps(2))


@pytest.fixture
def plateau(problem: Problem, members: Members) -> Population:
    """The best without more friction near standstill: level and steepness together act as a fifteenth of the viscous friction."""
    flat = problem.with_values(np.array([0.1, 0.3, 2.0, 0.0, 0.01]))
    found = fit_records(replace(flat, free=np.isin(flat.names, ["inertia", "viscous"])), starts=1).problem
    best = Population(found.values[None], found.initial[None], np.zeros(1))
    return replace(best, cost=members.normals(best)[0])


def test_what_another_does_as_well_does_not_matter(members: Members, plateau: Population) -> None:
    """Seen: level and steepness looked determined by themselves, only the decay was drawn anew, and the place was never left."""
    cost, _, hessian = members.normals(plateau)
    idle = idle_at(members.problem, plateau.values[0], float(cost[0]), hessian[0])
    assert idle.tolist() == [False, False, True, True, True]
    at_truth = replace(plateau, values=TRUTH[None])
    cost, _, hessian = members.normals(at_truth)
    assert not idle_at(members.problem, TRUTH, float(cost[0]), hessian[0]).any()


@pytest.mark.parametrize("seed", [0, 1])
def test_a_plateau_is_left(members: Members, plateau: Population, seed: int) -> None:
    """Where draws were chosen by their cost as drawn, the error stayed 8 % above the least one from every seed."""
    generator = np.random.default_rng(seed)
    draw = partial(_drawn, members.problem, spread=WIDE_SPREAD, generator=generator)
    found = off_the_plateau(members, plateau, draw, 64, generator)
    assert found is not None
    finer, places = found
    assert 2.0 * places.cost[0] / members.problem.samples < 1.02 * NOISE**2
    assert places.values[0] == pytest.approx(TRUTH, rel=0.1)
    assert (np.diff(places.cost) >= 0.0).all()
    assert finer.simulator.substeps >= members.simulator.substeps


def test_where_everything_matters_nothing_is_drawn(members: Members, plateau: Population) -> None:
    at_truth = replace(plateau, values=TRUTH[None], cost=members.normals(replace(plateau, values=TRUTH[None]))[0])

    def draw(count: int) -> Population:
        raise AssertionError(f"{count} drawn")

    assert off_the_plateau(members, at_truth, draw, 64, np.random.default_rng(0)) is None


def test_a_population_on_logarithms_descends_as_its_members_would(members: Members) -> None:
    """What is zero where a member begins is varied as it is, and may rise."""
    values = np.array([[0.11, 0.31, 1.1, 5.8, 21.0], [0.1, 0.3, 1.3, 6.5, 18.0], [0.1, 0.3, 0.0, 6.0, 20.0]])
    begun = Population(values, np.zeros((3, 1, 1)), np.full(3, np.inf))
    found = improve(LogarithmicMembers.of(members, begun), begun, 40)
    for k in range(2):
        run = FreeRun(members.problem.with_values(values[k]), members.simulator)
        descent = descending_on_logarithms(run.start, *run.bounds, settings=SETTINGS)
        alone = answered(descent, run.quadratic, lambda point: True)
        assert alone is not None
        assert found.cost[k] == pytest.approx(alone.model.cost, rel=1e-6)
        assert found.values[k] == pytest.approx(alone.point, rel=1e-3)
    assert found.values[2, 2] > 0.5
