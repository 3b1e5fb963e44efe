"""What an actuator does no faster than it can looks like a lag: what remembers is asked in the place of lags, beside the other laws."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.select import memory_for_lags
from greybox_torch.diagnosis.select.memory_for_lags import with_memory_for_lags
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.mechanisms.actuator import InputLag
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.friction import QuadraticDrag
from tests.diagnosis.conftest import STEP, Begun

DRAG, RAMP = 0.02, 6.0
"""N m s^2/rad^2; V/s."""


@pytest.fixture(scope="module")
def ramped(data_set, motor, begun) -> Begun:
    """The motor with a drag by the square of its speed, and a drive whose voltage changes no faster than a ramp."""
    rng, samples, fine = np.random.default_rng(5), 800, 20
    asked = np.repeat(rng.uniform(-4, 4, samples // 40), 40)
    acts, speed, speeds = asked[0], 0.0, []
    for voltage in asked:
        speeds.append(speed)
        for _ in range(fine):
            acts += float(np.clip(voltage - acts, -RAMP * STEP / fine, RAMP * STEP / fine))
            speed += STEP / fine * (0.1 * acts - 0.05 * speed - DRAG * speed * abs(speed)) / 0.02
    noisy = np.array(speeds) + rng.normal(0, 0.002, samples)
    channels = {"voltage": "V", "speed": "rad/s"}
    return begun(data_set(channels, [{"voltage": asked, "speed": noisy}], sample_time=STEP), motor)


def with_laws(search: Begun, *laws: tuple[str, object, dict[str, float]]) -> SearchState:
    """The state with laws at ports, refitted from some values."""
    effects, values = [], search.plain.values()
    for port, law, begun_at in laws:
        effects.append(attach(search.problem.model, port, law))
        values |= {f"{effects[-1].prefix}.{n}": v for n, v in begun_at.items()}
    return search.at(search.refitted(tuple(effects), search.plain, [values])).state


def test_a_ramp_is_found_in_the_place_of_a_lag_beside_a_drag(ramped: Begun) -> None:
    """Seen: a fan's drag and its drive's ramp, told as the drag, a lag of each of two sensors and a curve."""
    state = with_laws(ramped, ("rotor", QuadraticDrag(), {"c": 0.01}), ("actuator", InputLag(), {"T": 0.1}))
    found = result_of(with_memory_for_lags(ramped.study, state))
    assert {e.prefix for e in found.effects} == {"rotor.quadratic_drag", "actuator.unknown_rate_limit"}
    assert found.current.values()["actuator.unknown_rate_limit.R"] == pytest.approx(RAMP, rel=0.05)
    assert found.current.score < state.current.score - 1.0


@pytest.mark.parametrize("laws", ["no lag", "a lag alone"])
def test_nothing_is_computed_without_a_lag_or_without_another_law(ramped: Begun, monkeypatch, laws: str) -> None:
    monkeypatch.setattr(memory_for_lags, "fit", None)
    one = ("rotor", QuadraticDrag(), {"c": 0.01}) if laws == "no lag" else ("actuator", InputLag(), {"T": 0.1})
    state = with_laws(ramped, one)
    assert result_of(with_memory_for_lags(ramped.study, state)) is state


def test_a_lag_that_leaves_noise_stands(ramped: Begun, monkeypatch) -> None:
    state = with_laws(ramped, ("rotor", QuadraticDrag(), {"c": 0.01}), ("actuator", InputLag(), {"T": 0.1}))
    monkeypatch.setattr(memory_for_lags, "far_above_noise", lambda fitted, settings: False)
    monkeypatch.setattr(memory_for_lags, "fit", None)
    assert result_of(with_memory_for_lags(ramped.study, state)) is state


def test_it_has_to_complete_the_model(ramped: Begun, monkeypatch) -> None:
    state = with_laws(ramped, ("rotor", QuadraticDrag(), {"c": 0.01}), ("actuator", InputLag(), {"T": 0.1}))
    monkeypatch.setattr(memory_for_lags, "completes", lambda fitted, settings: False)
    assert result_of(with_memory_for_lags(ramped.study, state)) is state
