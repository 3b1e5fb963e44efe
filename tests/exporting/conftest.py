"""Machines with effects, and recordings to simulate them over."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.api.simulate import SimulationResult
from greybox_torch.mechanisms.actuator import InputLag
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
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
        own = self.simulated.run.simulated["steps"]
        return float((np.abs(outputs - own).max(0) / np.abs(own).max(0)).max())

    @property
    def start(self) -> list[float]:
        return list(self.simulated.run.initial["steps"].values())

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


def simulated(model: gt.GreyBoxModel, size: float, step: float, hold: str = "zoh", level: float = 0.0) -> Machine:
    draw = np.random.default_rng(5)
    inputs = {i.name: np.repeat(draw.uniform(-1, 1, 6), 20) * size + level for i in model.plain.inputs}
    outputs = {o.name: 0.01 * draw.normal(size=120) + level for o in model.outputs}
    recording = gt.Recording.from_arrays("steps", {**inputs, **outputs}, sample_time=step)
    data = gt.DataSet([recording], hold=hold, held_out_by_default=False)  # type: ignore[arg-type]
    return Machine(model, data, gt.simulate(model, data))


MACHINES: dict[str, Callable[[Path], Machine]] = {
    "arm with backlash and lag": lambda machines: simulated(arm(), 8.0, 5e-4),
    "double pendulum": lambda machines: simulated(
        gt.load_model(f"{machines / 'two_link.py'}:TwoLink"), 0.5, 0.01, "foh"
    ),
    "tank": lambda machines: simulated(gt.load_model(f"{machines / 'small.py'}:Tank"), 0.1, 0.05, level=0.5),
}


@pytest.fixture(scope="session", params=list(MACHINES))
def machine(request: pytest.FixtureRequest, machines: Path) -> Machine:
    return MACHINES[request.param](machines)


@pytest.fixture(scope="session")
def arm_with_effects(machines: Path) -> Machine:
    return MACHINES["arm with backlash and lag"](machines)
