from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import pytest

from greybox_torch.data import DataSet
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.refit.ranked import judged
from greybox_torch.diagnosis.refit.refitted import refitted
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select.plain_model import fit_plain_model
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.problem import Problem, all_starts_free, make_problem
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.simulator import SimulationOptions, Simulator
from greybox_torch.systems import RobotArm
from greybox_torch.systems.load import load_model
from tests.diagnosis.by_runge_kutta import by_runge_kutta

STEP = 0.01


@pytest.fixture(scope="session")
def motor(machines: Path) -> GreyBoxModel:
    """The documentation's motor."""
    return load_model(f"{machines / 'motor.py'}:Motor")


class MotorData(Protocol):
    def __call__(
        self,
        samples: int = ...,
        roles: tuple[str, ...] = ...,
        *,
        acting: Callable[[np.ndarray], np.ndarray] = ...,
        torque: Callable[[float, float], float] | None = ...,
        noise: float = ...,
        seed: int = ...,
    ) -> DataSet: ...


@pytest.fixture(scope="session")
def motor_data(data_set, motor_speed) -> MotorData:
    """Recordings of a motor with J 0.02 and b 0.05 under steps of voltage, simulated without the package.

    ``acting`` maps the recorded voltage to the one that acts; ``torque`` of position and speed is what the model does not know.
    """

    def make(samples=2000, roles=("estimation", "validation"), *, acting=lambda v: v, torque=None, noise=0.02, seed=0):
        rng, experiments = np.random.default_rng(seed), []
        for _ in roles:
            voltage = np.repeat(rng.uniform(-3, 3, samples // 20), 20)
            true = motor_speed(acting(voltage), start=0.3) if torque is None else turned(acting(voltage), torque)
            experiments.append({"voltage": voltage, "speed": true + rng.normal(0, noise, samples)})
        return data_set({"voltage": "V", "speed": "rad/s"}, experiments, roles=list(roles), sample_time=STEP)

    return make


def turned(voltage: np.ndarray, torque: Callable[[float, float], float], substeps: int = 4) -> np.ndarray:
    """The motor's speed with a further torque that depends on position and speed, by Runge-Kutta steps."""

    def rate(x: np.ndarray, v: float) -> np.ndarray:
        return np.array([x[1], (0.1 * v - 0.05 * x[1] + torque(x[0], x[1])) / 0.02])

    return by_runge_kutta(rate, np.array([0.4, 0.3]), voltage, STEP, substeps)[:, 1]


@dataclass(frozen=True)
class Begun:
    """A search that has fitted the model as it stands and knows its ports, or one that went on from there."""

    study: Study
    state: SearchState

    @property
    def problem(self) -> Problem:
        return self.study.problem

    @property
    def surroundings(self) -> Mapping[str, Surroundings]:
        return self.study.surroundings

    @property
    def options(self) -> SimulationOptions:
        return self.study.options

    @property
    def shifts(self) -> Mapping[str, str]:
        return self.study.shifts

    @property
    def plain(self) -> Hypothesis:
        return self.state.plain

    @property
    def current(self) -> Hypothesis:
        return self.state.current

    def refitted(
        self, effects: Sequence[Attachment], start: Hypothesis, starts: Sequence[dict[str, float]] = ()
    ) -> Hypothesis:
        found = refitted(self.study, effects, start, starts)
        assert found is not None
        return found

    def at(self, current: Hypothesis, **changes: Any) -> Begun:
        return Begun(self.study, replace(self.state.at(current), **changes))


@pytest.fixture(scope="session")
def begun() -> Callable[[DataSet, GreyBoxModel], Begun]:
    """A search that has fitted the model as it stands, and surveyed its ports."""

    def begin(dataset: DataSet, model: GreyBoxModel, substeps: int = 1) -> Begun:
        problem = all_starts_free(dataset, make_problem(dataset, model, dataset.estimation()))
        return Begun(*fit_plain_model(Study(problem, SimulationOptions(substeps=substeps))))

    return begin


@pytest.fixture(scope="session")
def dead_zone_search(motor_data, motor, begun) -> Begun:
    """The motor whose actuator does nothing below 0.5 V, before the first look."""
    return begun(motor_data(acting=lambda v: np.sign(v) * np.maximum(np.abs(v) - 0.5, 0.0)), motor)


@pytest.fixture(scope="session")
def arm_search(data_set, begun) -> Begun:
    """A short, rich record of the robot arm as the model has it."""
    from greybox_torch.simulation.records import Records
    from greybox_torch.simulation.windows import whole_records

    arm, n, step = RobotArm(), 1500, 1e-3
    t = step * np.arange(n)
    torque = 6.0 * np.sign(np.sin(4.0 * t)) + sum(np.sin(2 * np.pi * f * t + f) for f in (7.0, 13.0, 23.0))
    records = Records(torque[None], np.zeros((1, n)), np.full(n, step), np.array([0]), np.array([n - 1]), ("",), "zoh")
    p = np.array(list(arm.values().values()))
    speed = Simulator.of(arm, ()).run(records, Pass(whole_records(records), p, np.zeros((1, 5)))).y[0, :, 0]
    noisy = speed + np.random.default_rng(3).normal(0, 0.01, n)
    return begun(
        data_set(
            {"torque": "N m", "motor_speed": "rad/s"}, [{"torque": torque, "motor_speed": noisy}], sample_time=step
        ),
        arm,
    )


class Stub:
    """What a test needs of a larger object, and nothing else."""

    def __init__(self, **values: Any) -> None:
        vars(self).update(values)


@pytest.fixture(scope="session")
def stub() -> type[Stub]:
    return Stub


def found(search: Begun, effect: Attachment, start: dict[str, float]) -> SearchState:
    """The state of ``search`` after a step that took an effect."""
    fitted = search.refitted((effect,), search.plain, [search.plain.values() | start])
    taken = judged(Candidate(effect, (), 0.5), search.plain, fitted, search.study.settings)
    return replace(search.state.at(fitted), steps=(SelectionStep((), search.plain, (taken,), taken),))
