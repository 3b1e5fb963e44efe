"""`residuals`: prediction errors and their tests."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from greybox_torch import inspect, residuals
from greybox_torch.api.residuals import read
from greybox_torch.estimate.residuals import Correlation
from tests.api.motor import Motor
from tests.commands.free_running import PNG, Edit, Make, greybox, of, saved


def test_residuals(motor_folder: Make) -> None:
    """The right parameters leave white noise; the start values leave what the input explains."""
    folder = motor_folder()
    right = of("residuals", folder, "--checkpoint", saved(folder, "good"))
    assert (right["schema"], right["model"]["name"]) == ("greybox-residuals/1", "good")
    wrong = of("residuals", folder)
    assert wrong["model"]["name"] == "start"
    for good, poor in zip(right["residuals"], wrong["residuals"], strict=True):
        assert (good["experiment"], good["role"], good["output"]) == (poor["experiment"], poor["role"], poor["output"])
        assert good["rmse"] == pytest.approx(0.02, rel=0.15)
        assert good["whiteness"]["bound"] == pytest.approx(
            2.58 / np.sqrt(400 if good["experiment"] == "More steps" else 600)
        )
        assert (good["whiteness"]["lags"], good["input_correlation"]["lags"]) == (25, 26)
        assert good["whiteness"]["value"] < 1.5 * good["whiteness"]["bound"] < 0.5 < poor["whiteness"]["value"]
        crossed = good["input_correlation"]
        assert crossed["input"] == "voltage"
        assert crossed["inputs"] == {"voltage": {k: crossed[k] for k in ("value", "bound", "lags_outside", "lags")}}
        assert crossed["value"] < 1.5 * crossed["bound"]
    assert sum(row["whiteness"]["lags_outside"] for row in right["residuals"]) <= 3
    assert any(row["input_correlation"]["value"] > row["input_correlation"]["bound"] for row in wrong["residuals"])
    assert Path(right["figure"]).read_bytes().startswith(PNG)
    assert [p.name for p in (folder / "out").iterdir()] == ["residuals.png"]


def test_residuals_for_people(motor_folder: Make) -> None:
    result = greybox("residuals", motor_folder())
    assert (result.exit_code, result.stderr) == (0, "")
    assert "residuals of Motor, start" in result.stdout
    assert any(line.split()[:3] == ["Sweep", "validation", "speed"] for line in result.stdout.splitlines())


def test_the_table_says_what_is_white(motor_folder: Make) -> None:
    """Seen: 0.999 under "whiteness" was read as very white."""
    folder = motor_folder()
    wrong, right = (
        greybox("residuals", folder, *more).stdout for more in ((), ("--checkpoint", saved(folder, "good")))
    )
    assert "correlation" in wrong and "whiteness" not in wrong
    told = [[line.split()[-1] for line in text.splitlines() if " rad/s " in line] for text in (wrong, right)]
    assert told == [["no"] * 3, ["yes"] * 3]


def test_residuals_of_a_model_without_inputs(motor_folder: Make, edit: Edit) -> None:
    folder = motor_folder()
    edit(folder / "my_motor.py", '    inputs = [Input("voltage", "V")]\n', "")
    edit(folder / "my_motor.py", "p.k * u.voltage - p.b", "-p.b")
    edit(folder / "dataset.toml", 'voltage = { column = "v", unit = "V" }\n', "")
    assert [row["input_correlation"] for row in of("residuals", folder)["residuals"]] == [None] * 3


def test_an_input_that_does_not_move_has_no_correlation(data_set) -> None:
    """Seen: 0.43 (bound 0.79) with a rope whose length is the same throughout a recording."""
    time = 0.01 * np.arange(200)
    recorded = {"voltage": np.full(200, 0.9), "speed": np.sin(7.0 * time)}
    found = residuals(Motor(), data_set({"voltage": "V", "speed": "rad/s"}, [recorded]))
    (row,) = [line.split() for line in str(found).splitlines() if " estimation " in line]
    assert row[-3:] == ["-", "-", "no"]
    told = inspect(found.run.data).to_dict()["experiments"][0]["channels"]["voltage"]
    assert (told["min"], told["std"]) == (0.9, 0.0)


@pytest.mark.parametrize(
    ("colour", "with_input", "bound", "told"),
    [
        (
            0.999,
            0.05,
            0.3,
            "2 of 2 rows are not white, and none correlates with an input by more than chance gives over all lags: what is left",
        ),
        (
            0.999,
            0.9,
            0.3,
            "2 of 2 rows are not white, and 2 correlate with u by more than chance gives over all lags: that part a better",
        ),
        (0.999, 0.9, 1.4, "2 of 2 rows are not white; whether past inputs explain part of them cannot be judged"),
        (
            0.01,
            0.05,
            0.3,
            "All rows are white, and none correlates with an input by more than chance gives over all lags: nothing is left",
        ),
        (0.999, None, 0.3, "2 of 2 rows are not white: what is left repeats from sample to sample"),
    ],
)
def test_what_the_table_shows_is_said(colour: float, with_input: float | None, bound: float, told: str) -> None:
    """Seen: "above the bound, something repeatable is left", below a table with all correlations below theirs."""
    lags = np.arange(1, 26)
    inputs = {} if with_input is None else {"u": Correlation(lags, np.full(25, with_input), bound)}
    row: Any = SimpleNamespace(whiteness=Correlation(lags, np.full(25, colour), 0.06), inputs=inputs)
    assert read([row, row]).startswith(told)


def test_a_model_with_effects_is_not_sent_to_the_diagnosis_that_it_comes_from() -> None:
    row: Any = SimpleNamespace(
        whiteness=Correlation(np.arange(1, 26), np.full(25, 0.99), 0.06),
        inputs={"u": Correlation(np.arange(1, 26), np.full(25, 0.01), 0.3)},
    )
    assert read([row]).endswith("such as friction (`greybox diagnose` looks for the latter).")
    assert read([row], diagnosed=True).endswith("such as friction.")


def test_lags_of_a_slower_output_are_told_to_be_in_its_own_samples(data_set) -> None:
    rng = np.random.default_rng(0)
    recorded = {"voltage": rng.uniform(-1, 1, 600), "speed": 0.1 * rng.standard_normal(600)}
    slow = {**recorded, "speed": np.where(np.arange(600) % 4 == 0, recorded["speed"], np.nan)}
    for run, slower in ((recorded, False), (slow, True)):
        told = str(residuals(Motor(), data_set({"voltage": "V", "speed": "rad/s"}, [run])))
        assert ("speed: sampled more slowly than the rest, lags are in its own samples." in told) == slower
