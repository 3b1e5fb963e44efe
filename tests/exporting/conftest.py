"""Machines with effects, and recordings to simulate them over."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.api.simulate import SimulationResult
from greybox_torch.mechanisms.actuator import InputDelay, InputLag
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.balance import ThresholdFlow
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.mechanisms.transmission import Backlash


@dataclass(frozen=True)
class Machine:
    """A model, recordings, and what `greybox simulate` gives."""

    model: gt.GreyBoxModel
    data: gt.DataSet
    simulated: SimulationResult

    def largest_difference(self, outputs: np.ndarray) -> float:
        """Of outputs (n, n_y) from those of the only experiment, relative to the largest of each."""
        own = self.simulated.run.simulated[self.data.recordings[0].name][: len(outputs)]
        return float((np.abs(outputs - own).max(0) / np.abs(own).max(0)).max())

    @property
    def step(self) -> float | None:
        """None where samples are evenly spaced; else the longest interval, as `greybox simulate` takes a fixed number of steps for each."""
        spaces = np.diff(self.data.recordings[0].time)
        return None if np.allclose(spaces, spaces[0]) else float(spaces.max())

    @property
    def start(self) -> list[float]:
        return list(self.simulated.run.initial[self.data.recordings[0].name].values())

    @property
    def inputs(self) -> np.ndarray:
        """(n, n_u)."""
        recording = self.data.recordings[0]
        return np.column_stack([recording.signals[i.name] for i in self.model.inputs if i.name in recording.signals])


def arm() -> gt.GreyBoxModel:
    """The robot arm with backlash in its gear and a lagging drive."""
    around = {
        "gear_spring": Surroundings({"deflection": Range(-0.3, 0.3, 0.1), "rate": Range(-5, 5, 1)}, {"deflection": "rad"}, "N m", 5e-4),
        "actuator": Surroundings({"input": Range(-10, 10, 5)}, {"input": "N m"}, "N m", 5e-4),
    }  # fmt: skip
    attached = [Attachment("gear_spring", Backlash(), shifted_state="+gear_twist"), Attachment("actuator", InputLag())]
    made = AugmentedModel(gt.load_model("robot_arm"), attached, around)
    made.set_values({"gear_spring.backlash.half_gap": 0.03, "actuator.input_lag.T": 0.004})
    return made


def delayed_arm() -> gt.GreyBoxModel:
    """The robot arm with a drive that acts 3.3 samples later."""
    around = {"actuator": Surroundings({"input": Range(-10, 10, 5)}, {"input": "N m"}, "N m", 5e-4)}
    made = AugmentedModel(gt.load_model("robot_arm"), [Attachment("actuator", InputDelay())], around)
    made.set_values({"actuator.input_delay.T": 3.3 * 5e-4})
    return made


def double_pendulum(machines: Path) -> gt.GreyBoxModel:
    """Two links with Coulomb friction at both joints, and drives with dead times of their own."""
    around = {
        n: Surroundings({"speed": Range(-3, 3, 1)}, {"speed": "rad/s"}, "N m", 0.01) for n in ("shoulder", "elbow")
    }
    drives = ("actuator.tau1", "actuator.tau2")
    around |= {n: Surroundings({"input": Range(-1, 1, 0.5)}, {"input": "N m"}, "N m", 0.01) for n in drives}
    attached = [Attachment(n, CoulombFriction()) for n in ("shoulder", "elbow")]
    attached += [Attachment(n, InputDelay()) for n in drives]
    made = AugmentedModel(gt.load_model(f"{machines / 'two_link.py'}:TwoLink"), attached, around)
    made.set_values({"shoulder.coulomb_friction.F_c": 0.05, "elbow.coulomb_friction.F_c": 0.02})
    made.set_values({"actuator.tau1.input_delay.T": 0.05, "actuator.tau2.input_delay.T": 0.0231})
    return made


def quick_motor(machines: Path) -> gt.GreyBoxModel:
    """With a time constant of 20 ms."""
    made = gt.load_model(f"{machines / 'motor.py'}:Motor")
    made.set_values({"J": 0.02, "k": 0.1, "b": 1.0})
    return made


def simulated(model: gt.GreyBoxModel, size: float, step: float, hold: str = "zoh", level: float = 0.0) -> Machine:
    draw = np.random.default_rng(5)
    inputs = {i.name: np.repeat(draw.uniform(-1, 1, 6), 20) * size + level for i in model.plain.inputs}
    outputs = {o.name: 0.01 * draw.normal(size=120) + level for o in model.outputs}
    recording = gt.Recording.from_arrays("steps", {**inputs, **outputs}, sample_time=step)
    data = gt.DataSet([recording], hold=hold, held_out_by_default=False)  # type: ignore[arg-type]
    return Machine(model, data, gt.simulate(model, data))


MACHINES: dict[str, Callable[[Path], Machine]] = {
    "arm with backlash and lag": lambda machines: simulated(arm(), 8.0, 5e-4),
    "arm with a delay": lambda machines: simulated(delayed_arm(), 8.0, 5e-4),
    "double pendulum with friction and delays": lambda machines: simulated(double_pendulum(machines), 0.5, 0.01, "foh"),
    "motor with a large step": lambda machines: simulated(quick_motor(machines), 1.0, 0.02),
    "tank": lambda machines: simulated(gt.load_model(f"{machines / 'small.py'}:Tank"), 0.1, 0.05, level=0.5),
}


SHARED = Path(__file__).parents[3] / "shared" / "recordings"


def recorded_arm() -> Machine:
    return on_validation(SHARED / "robot_arm" / "dataset.toml", lambda plain: arm())


def recorded_pendulum() -> Machine:
    """Coulomb friction at both joints of a real double pendulum."""

    def with_friction(plain: gt.GreyBoxModel) -> gt.GreyBoxModel:
        around = Surroundings({"speed": Range(-10, 10, 4)}, {"speed": "rad/s"}, "N m", 0.002)
        joints = ("joint1", "joint2")
        attached = [Attachment(name, CoulombFriction()) for name in joints]
        made = AugmentedModel(plain, attached, dict.fromkeys(joints, around))
        made.set_values({"joint1.coulomb_friction.F_c": 0.2, "joint2.coulomb_friction.F_c": 0.15})
        return made

    return on_validation(SHARED / "elsewhere" / "double_pendulum" / "dataset.toml", with_friction)


def recorded_tanks() -> Machine:
    """Two real tanks in cascade, of which the upper one overflows."""

    def overflowing(plain: gt.GreyBoxModel) -> gt.GreyBoxModel:
        around = Surroundings({"level": Range(0, 10, 5)}, {"level": "V"}, "V/s", 4.0)
        made = AugmentedModel(plain, [Attachment("upper_tank", ThresholdFlow())], {"upper_tank": around})
        made.set_values({"upper_tank.threshold_flow.c": 0.1, "upper_tank.threshold_flow.threshold": 8.0})
        return made

    return on_validation(SHARED / "elsewhere" / "tanks" / "dataset.toml", overflowing)


def on_validation(card: Path, with_effects: Callable[[gt.GreyBoxModel], gt.GreyBoxModel]) -> Machine:
    """A model on the first validation experiment of a card."""
    if not card.is_file():
        pytest.skip(f"the real recordings, ../shared/recordings/{card.relative_to(SHARED)}, are not here")
    data = gt.load_dataset(card)
    assert data.model is not None
    first = next(r for r in data.recordings if r.role == "validation")
    one = gt.DataSet([first], hold=data.hold, held_out_by_default=False)
    model = with_effects(gt.load_model(data.model))
    return Machine(model, one, gt.simulate(model, one))


RECORDED = {"arm": recorded_arm, "double pendulum": recorded_pendulum, "tanks": recorded_tanks}


@pytest.fixture(scope="session", params=list(RECORDED))
def recorded(request: pytest.FixtureRequest) -> Machine:
    """A real machine with effects, on a validation experiment."""
    return RECORDED[request.param]()


@pytest.fixture(scope="session")
def made(machines: Path) -> Callable[[str], Machine]:
    """A machine by its name, simulated once."""
    return cache(lambda name: MACHINES[name](machines))


@pytest.fixture(scope="session", params=list(MACHINES))
def machine(request: pytest.FixtureRequest, made: Callable[[str], Machine]) -> Machine:
    return made(request.param)


@pytest.fixture(scope="session")
def arm_with_effects(made: Callable[[str], Machine]) -> Machine:
    return made("arm with backlash and lag")
