"""Static laws of saved models: rates at given states, without recordings."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from greybox_torch import SavedModel, load_saved_model
from greybox_torch.checkpoint import Checkpoint, save_checkpoint
from greybox_torch.errors import UserError
from greybox_torch.mechanisms.actuator import InputDelay
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.forces import AdditionalMode
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.mechanism import Mechanism, Range, Surroundings
from greybox_torch.mechanisms.stored import attachment_json

UNITS = {"J": "kg m^2", "k": "N m/V", "b": "N m s/rad"}
TRUE = {"J": 0.02, "k": 0.1, "b": 0.05}
RANGES = {"speed": Range(-6.0, 6.0, 3.0), "input": Range(-3.0, 3.0, 1.7)}
AROUND = Surroundings(RANGES, {"speed": "rad/s", "input": "V"}, "N m", 0.01)

Save = Callable[..., SavedModel]


@pytest.fixture
def saved(tmp_path: Path, machines: Path) -> Save:
    """Saves the documentation's motor, perhaps with an effect, and loads it again."""

    def make(mechanism: Mechanism | None = None, port: str = "rotor", **more: float) -> SavedModel:
        effects = [] if mechanism is None else [attachment_json(Attachment(port, mechanism), AROUND)]
        values = {**TRUE, **more}
        units = {name: UNITS.get(name, "") for name in values}
        save_checkpoint(tmp_path / "model", Checkpoint(f"{machines}/motor.py:Motor", "Motor", values, units, effects))
        return load_saved_model(tmp_path / "model", f"{machines}/motor.py:Motor")

    return make


def test_rates_are_the_equations(saved: Save) -> None:
    found = saved()
    speed = np.linspace(-5, 5, 11)
    assert found.rates({"speed": speed}, {"voltage": 2.0})["speed"] == pytest.approx((0.2 - 0.05 * speed) / 0.02)
    assert found.rates({})["speed"] == pytest.approx([0.0])


def test_rates_with_an_effect(saved: Save) -> None:
    prefix = "rotor.coulomb_friction"
    found = saved(CoulombFriction(), **{f"{prefix}.F_c": 0.3, f"{prefix}.v_0": 0.2})
    speed = np.linspace(-5, 5, 11)
    lost = 0.05 * speed + 0.3 * np.tanh(speed / 0.2)
    assert found.rates({"speed": speed})["speed"] == pytest.approx(-lost / 0.02, rel=1e-9)


def test_memories_are_as_they_begin(saved: Save) -> None:
    """A mass on a spring that begins along with the rotor does not hold it back."""
    prefix = "rotor.additional_mode"
    mode = {f"{prefix}.mass": 0.004, f"{prefix}.omega": 30.0, f"{prefix}.zeta": 0.1}
    found = saved(AdditionalMode(), **mode)
    speed = np.array([-2.0, 1.0, 4.0])
    rates = found.rates({"speed": speed})
    assert rates["speed"] == pytest.approx(-0.05 * speed / 0.02)
    assert rates[f"{prefix}.stretch"] == pytest.approx(np.zeros(3))


def test_names_that_there_are_not(saved: Save) -> None:
    found = saved()
    with pytest.raises(UserError, match=r"has no state 'sped' \(did you mean \"speed\"\?\); expected one of speed"):
        found.rates({"sped": np.zeros(3)})
    with pytest.raises(UserError, match=r"has no input 'current'; expected one of voltage"):
        found.rates({}, {"current": np.zeros(3)})
    with pytest.raises(UserError, match=r"rates: .*; expected numbers, or arrays of one length"):
        found.rates({"speed": np.zeros(3)}, {"voltage": np.zeros(2)})


def test_a_delayed_input_has_always_been_so(saved: Save) -> None:
    found = saved(InputDelay(), "actuator", **{"actuator.input_delay.T": 0.015})
    voltage = np.array([-2.0, 0.5, 3.0])
    assert found.rates({"speed": 1.0}, {"voltage": voltage})["speed"] == pytest.approx((0.1 * voltage - 0.05) / 0.02)
