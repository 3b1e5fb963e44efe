"""`evaluate`: what `greybox compare` and `residuals` compute, from Python, and the static laws of a model."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from greybox_torch import Evaluation, evaluate, load_dataset, load_model
from greybox_torch.checkpoint import Checkpoint, save_checkpoint
from greybox_torch.errors import UserError
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import Mechanism, Range, Surroundings
from greybox_torch.mechanisms.stored import attachment_json

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
    assert found.scores[0].keys() == {"experiment", "role", "output", "fit", "rmse", "unit"}
    assert [row["experiment"] for row in found.scores] == ["Steps", "More steps", "Sweep"]
    assert [row["rmse"] for row in found.scores] == pytest.approx([0.02] * 3, rel=0.15)
    assert found.rates({"speed": 1.0})["speed"] == pytest.approx([-0.05 / 0.02])
    assert list(found.simulated) == ["Steps", "More steps", "Sweep"]
    for recording, row, residuals in zip(data.recordings, found.scores, found.residuals, strict=True):
        errors = recording.signals["speed"] - found.simulated[recording.name][:, 0]
        assert np.array_equal(residuals.errors, errors)
        assert row["rmse"] == pytest.approx(np.sqrt(np.mean(errors**2)))
        assert residuals.whiteness.largest < 1.6 * residuals.whiteness.bound  # the largest of 25 lags
        assert list(residuals.inputs) == ["voltage"]


def test_it_prints_its_summary(motor_folder: Make) -> None:
    """Seen: all arrays of the problem."""
    folder = motor_folder()
    title, *rows = str(evaluate(load_dataset(folder / "dataset.toml"), saved(folder))).splitlines()
    assert title.endswith(": Motor")
    assert [row.split(":")[0].strip() for row in rows] == [
        "Steps (estimation), speed",
        "More steps (estimation), speed",
        "Sweep (validation), speed",
    ]
    assert all(" %, root mean square error 0.0" in row and row.endswith(" rad/s") for row in rows)


def test_start_values_miss_something_that_the_input_explains(motor_folder: Make) -> None:
    found = evaluate(load_dataset(motor_folder() / "dataset.toml"))
    assert found.values == {"J": 0.03, "k": 0.1, "b": 0.08}
    for residuals in found.residuals:
        assert residuals.whiteness.outside > 20
        assert residuals.inputs["voltage"].largest > residuals.inputs["voltage"].bound


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


def test_a_simulation_that_diverges_is_told_with_its_time(motor_folder: Make) -> None:
    """Seen: a fit of -2e102 %, and "the motion is fast for the sample time"."""
    folder = motor_folder()
    data = load_dataset(folder / "dataset.toml")
    assert evaluate(data, saved(folder)).diverging == ()
    (code := folder / "my_motor.py").write_text(code.read_text().replace("- p.b * x.speed", "+ 10.0 * p.b * x.speed"))
    lines = evaluate(data, saved(folder)).diverging
    assert len(lines) == 3 and "the simulation of 'Steps' diverges, so that fits say nothing: from" in lines[0]
    assert (
        "speed is more than 100 times its measured range off" in lines[0] and "the signs in its equations" in lines[0]
    )
