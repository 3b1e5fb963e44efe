""""""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from greybox_torch.checkpoint import load_checkpoint
from greybox_torch.data import load_dataset
from tests.commands.fitting import Edit, Make, fit


def test_json(motor_folder: Make) -> None:
    folder = motor_folder()
    result = fit(folder, "--json")
    assert result.exit_code == 0
    found = json.loads(result.stdout)
    assert found == json.loads((folder / "out" / "fit.json").read_text())
    assert (found["schema"], found["dataset"]) == ("greybox-fit/1", "Motor on the bench")
    assert found["model"] == f"{folder.resolve()}/my_motor.py:Motor"
    assert found["seconds"] > 0
    assert list(found["parameters"]) == ["J", "k", "b"]
    inertia, gain, damping = found["parameters"].values()
    assert inertia["value"] == pytest.approx(0.02, rel=0.02)
    assert damping["value"] == pytest.approx(0.05, rel=0.02)
    assert abs(inertia["value"] - 0.02) < 4 * inertia["std"] < 0.02 * 0.02
    assert (inertia["unit"], inertia["fixed"], inertia["lower"], inertia["upper"]) == ("kg m^2", False, 0.0, None)
    assert (gain["value"], gain["std"], gain["fixed"], damping["upper"]) == (0.1, 0.0, True, 1.0)
    assert list(found["initial"]) == ["Steps", "More steps"]
    start = found["initial"]["More steps"]["speed"]
    assert start["value"] == pytest.approx(0.3, abs=0.05)
    assert 0 < start["std"] < 0.02
    assert (start["unit"], start["fixed"]) == ("rad/s", False)
    rows = found["fit"]
    assert [(r["experiment"], r["role"], r["output"]) for r in rows] == [
        ("Steps", "estimation", "speed"),
        ("More steps", "estimation", "speed"),
        ("Sweep", "validation", "speed"),
    ]
    for row in rows:
        assert row["start"]["fit"] < row["refit"]["fit"]
        assert row["refit"]["rmse"] == pytest.approx(0.02, rel=0.15)
        assert row["start"]["rmse"] > 0.05
    statistics = found["statistics"]
    assert statistics["mse"] == pytest.approx(0.02**2, rel=0.15)
    assert statistics["fpe"] == pytest.approx(statistics["mse"] * (1 + 4 / 1000) / (1 - 4 / 1000))
    assert (statistics["status"], statistics["samples"]) == ("converged", 1000)
    assert 0 < statistics["iterations"] <= statistics["evaluations"]


def test_summary(motor_folder: Make, edit: Edit) -> None:
    folder = motor_folder()
    edit(folder / "my_motor.py", 'unit="kg m^2", lower=0.0', 'unit="kg m^2", lower=0.0, description="rotor with load"')
    result = fit(folder)
    assert result.exit_code == 0
    lines = [" ".join(line.split()) for line in result.stdout.splitlines()]
    assert any(
        line.startswith("J rotor with load kg m^2 0.0") and line.endswith("[0, inf] estimated") for line in lines
    )
    assert "k N m/V 0.1 [0, inf] fixed" in lines
    assert any(line.startswith("b N m s/rad 0.0") and line.endswith("[0, 1] estimated") for line in lines)
    assert {"Initial states of Steps", "Initial states of More steps"} <= set(lines)
    assert any(line.startswith("speed rad/s 0.3") and line.endswith("estimated") for line in lines)
    for name in (
        "termination: converged",
        "iterations: ",
        "evaluations: ",
        "mean squared error: ",
        "final prediction error: ",
    ):
        assert any(line.startswith(name) for line in lines), name
    assert sum(line.endswith(" (rad/s)^2") for line in lines) == 2
    assert any(line.startswith("Sweep validation speed") for line in lines)
    assert "iteration 1: mean squared error" in result.stderr
    assert result.stderr.count("iteration") == 2, "the first and the last"


def test_checkpoint(motor_folder: Make) -> None:
    folder = motor_folder()
    found = json.loads(fit(folder, "--json").stdout)
    saved = load_checkpoint(Path(found["checkpoint"]))
    assert saved.title == "Motor"
    assert saved.model == f"{folder.resolve()}/my_motor.py:Motor"
    assert saved.values == {name: p["value"] for name, p in found["parameters"].items()}
    assert saved.units == {"J": "kg m^2", "k": "N m/V", "b": "N m s/rad"}
    assert saved.effects == []
    assert saved.dataset == load_dataset(folder / "dataset.toml").sha256
    assert saved.figures == found["fit"]
    files = {"fit.json", "model.json", "model.safetensors"}
    assert {path.name for path in (folder / "out").iterdir()} == files


def test_nothing_free(motor_folder: Make, edit: Edit) -> None:
    folder = motor_folder()
    edit(folder / "dataset.toml", "J = { value = 0.03 }", "J = { fixed = true }")
    edit(
        folder / "dataset.toml",
        "upper = 1.0 }",
        "fixed = true }\n[model.initial]\nspeed = { value = 0.3, fixed = true }",
    )
    result = fit(folder)
    assert result.exit_code == 0
    assert "nothing to estimate: every parameter and initial state is fixed" in result.stdout
    assert json.loads(fit(folder, "--json").stdout)["statistics"]["status"] == "nothing_free"


def test_the_last_quarter_held_out(motor_folder: Make, edit: Edit) -> None:
    folder = motor_folder()
    edit(folder / "dataset.toml", '"validation"', '"estimation"')
    result = fit(folder)
    assert "the last quarter of each is held out" in result.stdout
    rows = json.loads((folder / "out" / "fit.json").read_text())["fit"]
    assert [r["experiment"] for r in rows if r["role"] == "validation"] == [
        f"{name} (held out)" for name in ("Steps", "More steps", "Sweep")
    ]


def test_same_result_whatever_the_seed(motor_folder: Make) -> None:
    folder = motor_folder()
    first = json.loads(fit(folder, "--json", "--seed", "1").stdout)
    second = json.loads(fit(folder, "--json", "--seed", "2").stdout)
    assert first["parameters"] == second["parameters"]


def test_single_precision(motor_folder: Make) -> None:
    folder = motor_folder()
    double, single = (json.loads(fit(folder, "--json", "--precision", p).stdout) for p in ("double", "single"))
    assert single["precision"] == "single"
    assert single["statistics"]["status"] == "converged"
    for name in ("J", "b"):
        assert single["parameters"][name]["value"] == pytest.approx(double["parameters"][name]["value"], rel=1e-3)
        assert single["parameters"][name]["value"] != double["parameters"][name]["value"]
        assert single["parameters"][name]["std"] == pytest.approx(double["parameters"][name]["std"], rel=1e-2)
