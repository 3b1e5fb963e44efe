"""`evaluate`: what `greybox compare` and `residuals` compute, from Python, and the static laws of a model."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from greybox_torch import Evaluation, evaluate, load_dataset, load_model
from greybox_torch.checkpoint import Checkpoint, save_checkpoint
from greybox_torch.diagnose.restore import attachment_json
from greybox_torch.errors import UserError
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.forces import AdditionalMode
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.mechanism import Mechanism, Range, Surroundings

Make = Callable[..., Path]
UNITS = {"J": "kg m^2", "k": "N m/V", "b": "N m s/rad"}
TRUE = {"J": 0.02, "k": 0.1, "b": 0.05}
AROUND = Surroundings({"speed": Range(-6.0, 6.0, 3.0)}, {"speed": "rad/s"}, "N m", 0.01)


def saved(folder: Path, mechanism: Mechanism | None = None, **more: float) -> Path:
    effects = [] if mechanism is None else [attachment_json(Attachment("rotor", mechanism), AROUND)]
    values = {**TRUE, **more}
    units = {name: UNITS.get(name, "") for name in values}
    save_checkpoint(folder / "model", Checkpoint(f"{folder}/my_motor.py:Motor", "Motor", values, units, effects))
    return folder / "model"


def test_true_values_leave_the_noise(motor_folder: Make) -> None:
    folder = motor_folder()
    data = load_dataset(folder / "dataset.toml")
    found = evaluate(data, saved(folder))
    assert found.values == TRUE
    assert found.overflow is None
    assert [score.experiment for score in found.scores] == ["Steps", "More steps", "Sweep"]
    assert [score.rmse for score in found.scores] == pytest.approx([0.02] * 3, rel=0.15)
    assert list(found.simulated) == ["Steps", "More steps", "Sweep"]
    for recording, score, residuals in zip(data.recordings, found.scores, found.residuals, strict=True):
        errors = recording.signals["speed"] - found.simulated[recording.name][:, 0]
        assert np.array_equal(residuals.errors, errors)
        assert score.rmse == pytest.approx(np.sqrt(np.mean(errors**2)))
        assert residuals.whiteness.largest < 1.6 * residuals.whiteness.bound  # the largest of 25 lags
        assert list(residuals.inputs) == ["voltage"]


def test_start_values_miss_something_that_the_input_explains(motor_folder: Make) -> None:
    found = evaluate(load_dataset(motor_folder() / "dataset.toml"))
    assert found.values == {"J": 0.03, "k": 0.1, "b": 0.08}
    for residuals in found.residuals:
        assert residuals.whiteness.outside > 20
        assert residuals.inputs["voltage"].largest > residuals.inputs["voltage"].bound


def test_rates_are_the_equations(motor_folder: Make) -> None:
    folder = motor_folder()
    found = evaluate(load_dataset(folder / "dataset.toml"), saved(folder))
    speed = np.linspace(-5, 5, 11)
    assert found.rates({"speed": speed}, {"voltage": 2.0})["speed"] == pytest.approx((0.2 - 0.05 * speed) / 0.02)
    assert found.rates({})["speed"] == pytest.approx([0.0])


def test_rates_with_an_effect(motor_folder: Make) -> None:
    folder = motor_folder()
    prefix = "rotor.coulomb_friction"
    path = saved(folder, CoulombFriction(), **{f"{prefix}.F_c": 0.3, f"{prefix}.v_0": 0.2})
    found = evaluate(load_dataset(folder / "dataset.toml"), path)
    speed = np.linspace(-5, 5, 11)
    lost = 0.05 * speed + 0.3 * np.tanh(speed / 0.2)
    assert found.rates({"speed": speed})["speed"] == pytest.approx(-lost / 0.02, rel=1e-9)


def test_memories_are_as_they_begin(motor_folder: Make) -> None:
    """A mass on a spring that begins along with the rotor does not hold it back."""
    folder = motor_folder()
    prefix = "rotor.additional_mode"
    mode = {f"{prefix}.mass": 0.004, f"{prefix}.omega": 30.0, f"{prefix}.zeta": 0.1}
    found = evaluate(load_dataset(folder / "dataset.toml"), saved(folder, AdditionalMode(), **mode))
    speed = np.array([-2.0, 1.0, 4.0])
    rates = found.rates({"speed": speed})
    assert rates["speed"] == pytest.approx(-0.05 * speed / 0.02)
    assert rates[f"{prefix}.stretch"] == pytest.approx(np.zeros(3))


def test_names_that_there_are_not(motor_folder: Make) -> None:
    found = evaluate(load_dataset(motor_folder() / "dataset.toml"))
    with pytest.raises(UserError, match=r"has no state 'sped' \(did you mean \"speed\"\?\); expected one of speed"):
        found.rates({"sped": np.zeros(3)})
    with pytest.raises(UserError, match=r"has no input 'current'; expected one of voltage"):
        found.rates({}, {"current": np.zeros(3)})


def test_which_model(motor_folder: Make, edit: Callable[[Path, str, str], None]) -> None:
    folder = motor_folder()
    card = folder / "dataset.toml"
    edit(card, 'name = "my_motor.py:Motor"\n', "")
    with pytest.raises(UserError, match=r"\[model\] name is missing and no model is given"):
        evaluate(load_dataset(card))
    given = evaluate(load_dataset(card), model=load_model(f"{folder}/my_motor.py:Motor"))
    assert isinstance(given, Evaluation)
    assert given.values["J"] == 0.03
    assert evaluate(load_dataset(card), saved(folder), model=load_model(f"{folder}/my_motor.py:Motor")).values == TRUE
