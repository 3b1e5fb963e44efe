"""A model that lacks nothing, in a local minimum of the fit over windows."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.diagnosis.select import other_values as module
from greybox_torch.diagnosis.select.other_values import other_values
from tests.diagnosis.conftest import STEP, turned

PHASE, CARD = 6.0, 1.0


class Unbalanced(gt.GreyBoxModel):
    """J dw/dt = 0.1 u − b w + 0.05 sin(angle + phase), the phase between 0 and a turn."""

    states = [gt.State("angle", "rad", initial="measured"), gt.State("speed", "rad/s", initial="measured")]
    inputs, outputs = [gt.Input("voltage", "V")], [gt.Output("angle", "rad"), gt.Output("speed", "rad/s")]
    parameters = [
        gt.Parameter("J", 0.02, unit="kg m^2", lower=0.0, fixed=True),
        gt.Parameter("b", 0.05, unit="N m s/rad", lower=0.0, fixed=True),
        gt.Parameter("phase", CARD, unit="rad", lower=0.0, upper=2 * np.pi),
    ]
    ports = [gt.Body("rotor", speed="speed", position="angle")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        unbalance = 0.05 * (x.angle + p.phase).sin()
        return {"angle": x.speed, "speed": (0.1 * u.voltage - p.b * x.speed + unbalance + port.rotor) / p.J}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"angle": x.angle, "speed": x.speed}


@pytest.fixture(scope="module")
def in_local_minimum(data_set, begun) -> Any:
    """The search begun from the card: the phase runs to zero, from where the truth is a small step beyond the bound."""
    rng = np.random.default_rng(1)
    voltage = np.repeat(rng.uniform(-2, 2, 100), 20)
    speed = turned(voltage, lambda angle, speed: 0.05 * np.sin(angle + PHASE))
    angle = 0.4 + np.concatenate([[0.0], np.cumsum(0.5 * STEP * (speed[1:] + speed[:-1]))])
    noisy = {"voltage": voltage, "angle": angle + rng.normal(0, 1e-3, 2000), "speed": speed + rng.normal(0, 1e-2, 2000)}
    return begun(data_set({"voltage": "V", "angle": "rad", "speed": "rad/s"}, [noisy], sample_time=STEP), Unbalanced())


def test_values_are_found_that_leave_noise_alone(in_local_minimum) -> None:
    study, state = in_local_minimum.study, in_local_minimum.state
    assert state.plain.values()["phase"] < 0.01
    found = other_values(study, state)
    assert found is not None
    assert found[1].plain.values()["phase"] == pytest.approx(PHASE, abs=0.01)
    assert found[1].current is found[1].plain
    assert other_values(*found) is None  # nothing more is asked for where noise alone is left


def test_what_leaves_less_with_its_effects_stands(in_local_minimum, monkeypatch) -> None:
    study, state = in_local_minimum.study, in_local_minimum.state
    monkeypatch.setattr(module, "only_noise", lambda problem, fitted, settings: False)
    better = replace(state.current, fits=tuple(replace(f, mean_square=1e-12) for f in state.current.fits))
    monkeypatch.setattr(module, "times_noise", lambda problem, fitted, settings: 10.0)
    assert other_values(study, replace(state, current=better)) is None


def test_a_model_without_free_parameters_is_not_asked(in_local_minimum) -> None:
    study, state = in_local_minimum.study, in_local_minimum.state
    fixed = replace(study, problem=study.problem.fixed, report=pytest.fail)
    assert other_values(fixed, state) is None
