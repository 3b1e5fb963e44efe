"""Positions that no sensor shows, from the speed that one does."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greybox_torch.estimate.carried_starts import carried_starts
from greybox_torch.estimate.integrated_speeds import integrated_speeds
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.mechanisms.attachment import Attachment, attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.mechanisms.sensor import SensorBias, SensorLag
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.model import GreyBoxModel, Parameter
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import cut
from tests.mechanisms.test_carried_memories import Motor

STEP, SAMPLES, RATE = 0.01, 400, 3.0
SPAN = Range(-2.0, 2.0, 1.0)
AROUND = Surroundings(dict.fromkeys(("speed", "position", "time", "output"), SPAN), {}, "N m", STEP)


class WithGain(Motor):
    """Its sensor shows the speed times a parameter that happens to be one."""

    parameters = [Parameter("b", 0.1), Parameter("shown", 1.0)]

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": p.shown * x.speed}


@pytest.fixture
def problem(data_set: Any) -> Any:
    """Two experiments of the speed cos 3 t and 2 cos 3 t, whatever drives them."""

    def make(model: GreyBoxModel, *further: Attachment) -> Problem:
        t = STEP * np.arange(SAMPLES)
        experiments = [{"voltage": 0.0 * t, "speed": size * np.cos(RATE * t)} for size in (1.0, 2.0)]
        data = data_set({"voltage": "V", "speed": "rad/s"}, experiments, sample_time=STEP)
        effects = (attach(model, "rotor", TorqueRipple(4.0)), *further)
        augmented = AugmentedModel(model, effects, {"rotor": AROUND, "sensor": AROUND})
        return make_problem(data, augmented, data.estimation())

    return make


def test_is_the_analytic_integral_of_every_experiment(problem: Any) -> None:
    made = problem(Motor())
    names = [s.name for s in made.model.states]
    samples = np.array([0, 137, SAMPLES - 1, SAMPLES, SAMPLES + 250])
    (position, gone), *more = integrated_speeds(made, samples).items()
    assert names[position] == "rotor.position" and not more
    analytic = np.array([1, 1, 1, 2, 2]) * np.sin(RATE * STEP * (samples % SAMPLES)) / RATE
    np.testing.assert_allclose(gone, analytic, atol=1e-4)


@pytest.mark.parametrize("law", [SensorBias(), SensorLag()])
def test_a_sensor_that_adds_something_shows_no_speed(problem: Any, law: Any) -> None:
    """Its integral would drift from the position by what the sensor adds."""
    assert not integrated_speeds(problem(Motor(), Attachment("sensor", law)), np.array([100]))


def test_an_output_that_is_a_state_only_at_declared_values_shows_none(problem: Any) -> None:
    assert not integrated_speeds(problem(WithGain()), np.array([100]))


def test_windows_begin_there_whatever_the_model_does_between(problem: Any) -> None:
    """The model stands still, as nothing drives it; the machine moved."""
    made = problem(Motor())
    windows = cut(made.records, 50)
    position = [s.name for s in made.model.states].index("rotor.position")
    first = np.zeros((len(windows.start), len(made.model.states)))
    first[made.records.experiments(windows.start) == 1, position] = 0.7
    starts = carried_starts(made, Simulator.of(made.model, ()), windows, first)
    of = made.records.experiments(windows.start)
    gone = np.array([1.0, 2.0])[of] * np.sin(RATE * STEP * (windows.start % SAMPLES)) / RATE
    np.testing.assert_allclose(starts[:, position], np.array([0.0, 0.7])[of] + gone, atol=1e-4)
