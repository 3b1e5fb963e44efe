from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from greybox_torch.checkpoint import load_checkpoint
from greybox_torch.cli import app
from greybox_torch.data import load_dataset

Make = Callable[..., Path]
Edit = Callable[[Path, str, str], None]


def fit(folder: Path, *options: str) -> Result:
    return CliRunner().invoke(app, ["fit", str(folder / "dataset.toml"), "--out", str(folder / "out"), *options])


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
    assert any(line.startswith("Sweep validation speed") for line in lines)
    assert "iteration 1: mean squared error" in result.stderr
    assert "iteration 2: mean squared error" in result.stderr


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


def test_says_what_the_data_do_not_determine(motor_folder: Make, edit: Edit) -> None:
    folder = motor_folder()
    edit(folder / "dataset.toml", "[model.parameters]", "[model.parameters]\nk = { fixed = false }")
    result = fit(folder)
    assert "The data do not determine J, k and b, alone or together" in result.stdout
    assert "undetermined" in result.stdout
    assert json.loads(fit(folder, "--json").stdout)["parameters"]["J"]["std"] is None


def test_says_what_is_at_a_bound(motor_folder: Make, edit: Edit) -> None:
    folder = motor_folder()
    edit(folder / "dataset.toml", "upper = 1.0", "lower = 0.07")
    result = fit(folder)
    assert "At a bound: b" in result.stdout


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


def test_identifiability_is_told_before_estimating(motor_folder: Make, edit: Edit) -> None:
    folder = motor_folder()
    edit(folder / "dataset.toml", "[model.parameters]", "[model.parameters]\nk = { fixed = false }")
    result = fit(folder, "--json")
    assert result.exit_code == 0
    lines = result.stderr.splitlines()
    assert lines[0].startswith("At the start values: J, k and b: only their ratios are determined")
    assert "iteration 1" in lines[1]
    found = json.loads(result.stdout)
    (row,) = found["identifiability"]
    assert (row["kind"], row["parameters"], row["at"]) == ("together", ["J", "k", "b"], ["start", "optimum"])
    assert row["direction"] == pytest.approx([1.0, 1.0, 1.0])
    assert "raising all by the same factor changes nothing" in row["sentence"]
    (note,) = found["statistics"]["notes"]
    assert note["kind"] == "rank_deficient"
    assert "(J, k and b)" in note["sentence"]
    assert found["correlation"] == {"names": ["J", "k", "b"], "matrix": [[None] * 3] * 3}


def test_nothing_to_tell_of_a_sound_problem(motor_folder: Make) -> None:
    found = json.loads(fit(motor_folder(), "--json").stdout)
    assert (found["identifiability"], found["statistics"]["notes"], found["profiles"]) == ([], [], {})
    assert (found["substeps"], found["precision"]) == (1, "double")
    names, matrix = found["correlation"].values()
    assert names == ["J", "b"]
    assert [matrix[0][0], matrix[1][1]] == pytest.approx([1.0, 1.0])
    assert matrix[0][1] == pytest.approx(matrix[1][0])
    assert -1 < matrix[0][1] < 1


def test_strong_correlations_are_told(motor_folder: Make, edit: Edit) -> None:
    """Two frictions that act alike but for a little."""
    folder = motor_folder()
    edit(folder / "my_motor.py", "- p.b * x.speed", "- p.b * x.speed - p.c * x.speed * (1 + 0.02 * x.speed)")
    edit(folder / "my_motor.py", "    ports =", '    parameters += [Parameter("c", 0.01)]\n    ports =')
    result = fit(folder)
    assert "Estimates that move together (correlation): b and c -0." in result.stdout


def test_bounds_in_the_result(motor_folder: Make, edit: Edit) -> None:
    folder = motor_folder()
    edit(folder / "dataset.toml", "upper = 1.0", "lower = 0.07")
    (note,) = json.loads(fit(folder, "--json").stdout)["statistics"]["notes"]
    assert note["kind"] == "at_bound"
    assert note["sentence"].startswith("ended at a bound") and "(b)" in note["sentence"]


def test_profiles(motor_folder: Make) -> None:
    folder = motor_folder()
    result = fit(folder, "--json", "--profile", "J", "--profile", "b", "--profile", "J")
    found = json.loads(result.stdout)
    assert list(found["profiles"]) == ["J", "b"]
    for name, row in found["profiles"].items():
        estimate, deviation = found["parameters"][name]["value"], found["parameters"][name]["std_sandwich"]
        assert row["estimate"] == estimate
        assert [row["lower"], row["upper"]] == pytest.approx(
            [estimate - 1.96 * deviation, estimate + 1.96 * deviation], rel=1e-3
        )
        assert row["colour"] == pytest.approx((deviation / found["parameters"][name]["std"]) ** 2)
        assert len(row["values"]) == len(row["rise"]) > 6
        assert (folder / "out" / f"profile_{name}.png").read_bytes().startswith(b"\x89PNG")
        assert f"{name}: {row['lower']:.5g}" in result.stderr
    assert json.loads((folder / "out" / "fit.json").read_text()) == found


@pytest.mark.parametrize("name", ["bb", "k"])
def test_profiles_that_are_refused(motor_folder: Make, name: str) -> None:
    said = {"bb": 'no parameter of that name (did you mean "b"?)', "k": "this parameter is fixed"}[name]
    check_refused(motor_folder(), 2, f"--profile {name}: ", said, "J, b", options=("--profile", name))


def test_single_precision(motor_folder: Make) -> None:
    folder = motor_folder()
    double, single = (json.loads(fit(folder, "--json", "--precision", p).stdout) for p in ("double", "single"))
    assert single["precision"] == "single"
    assert single["statistics"]["status"] == "converged"
    for name in ("J", "b"):
        assert single["parameters"][name]["value"] == pytest.approx(double["parameters"][name]["value"], rel=1e-3)
        assert single["parameters"][name]["value"] != double["parameters"][name]["value"]
        assert single["parameters"][name]["std"] == pytest.approx(double["parameters"][name]["std"], rel=1e-2)


def test_substeps_are_told(motor_folder: Make, edit: Edit) -> None:
    """A motor whose lag is a fraction of the sample time takes several steps a sample."""
    folder = motor_folder()
    edit(folder / "dataset.toml", "J = { value = 0.03 }", "J = { value = 0.0004, fixed = true }")
    result = fit(folder, "--json")
    steps = json.loads(result.stdout)["substeps"]
    assert steps > 1
    assert f"Each sample is simulated in {steps} Runge-Kutta steps" in result.stderr


REFUSED = {
    "no estimation experiment": (
        [
            ('"Steps"\nfile = "steps.csv"\nrole = "estimation"', '"Steps"\nfile = "steps.csv"\nrole = "validation"'),
            ('"more.csv"\nrole = "estimation"', '"more.csv"\nrole = "validation"'),
        ],
        [],
        ["dataset.toml", 'no experiment has the role "estimation"'],
    ),
    "unknown parameter": ([("J = {", "Jay = {")], [], ["[model.parameters] Jay", "Motor has no such name", "J, k, b"]),
    "value outside its bounds": ([("value = 0.03", "value = -0.03")], [], ["'J': value -0.03", "[0, inf]"]),
    "unknown initial state": (
        [("[model.parameters]", "[model.initial]\nspede = { value = 1.0 }\n[model.parameters]")],
        [],
        ["[model.initial] spede", "did you mean 'speed'"],
    ),
    "wrong unit": ([('unit = "rad/s"', 'unit = "rpm"')], [], ["[channels] speed", "'rpm'", "'rad/s'"]),
    "misspelt channel": ([("speed = {", "sped = {")], [], ["[channels] has no 'speed'", "sped"]),
    "unknown model": ([], ["--model", "robot_leg"], ["model 'robot_leg' is unknown", "robot_arm"]),
    "no model": ([('[model]\nname = "my_motor.py:Motor"\n', "")], [], ["[model] name is missing", "--model"]),
    "another model": ([], ["--model", "robot_arm"], ["[channels] has no 'torque'"]),
    "missing class": ([("py:Motor", "py:Engine")], [], ["my_motor.py", "class 'Engine' is not defined", "Motor"]),
    "unknown device": ([], ["--device", "tpu"], ["--device tpu: expected", '"cpu", "cuda"']),
    "device that is not there": ([], ["--device", "cuda:99"], ["--device cuda:99: this machine has"]),
    "unknown precision": (
        [],
        ["--precision", "doubel"],
        ["--precision doubel: expected", '"single" (did you mean "double"?)'],
    ),
    "device without float64": ([], ["--device", "mps"], ["--device mps: expected"]),
}


@pytest.mark.parametrize(("changes", "options", "expected"), REFUSED.values(), ids=REFUSED)
def test_refused(
    motor_folder: Make, edit: Edit, changes: list[tuple[str, str]], options: list[str], expected: list[str]
) -> None:
    folder = motor_folder()
    for old, new in changes:
        edit(folder / "dataset.toml", old, new)
    check_refused(folder, 2, *expected, options=options)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("/ p.J", "/ 0 + undefined", ["my_motor.py, line 20: ", "NameError: name 'undefined' is not defined"]),
        ("u.voltage", "u.volts", ["my_motor.py, class Motor: ", "the input 'volts'", "declared: voltage"]),
        ("class Motor", "1 / 0\nclass Motor", ["my_motor.py, line 6: running it raised ZeroDivisionError"]),
        ("class Motor(", "class Motor:\nclass Engine(", ["my_motor.py, line 7: running it raised IndentationError"]),
        ("return {\"speed\": x.speed}", "return {}", ["Motor.output() returned nothing; expected speed"]),
        ("p.b * x.speed", "(p.b if x.speed > 0 else 0.0) * x.speed", ["my_motor.py, line ", "torch.where(condition"]),
    ],
)  # fmt: skip
def test_model_files_that_are_refused(motor_folder: Make, edit: Edit, old: str, new: str, expected: list[str]) -> None:
    folder = motor_folder()
    edit(folder / "my_motor.py", old, new)
    check_refused(folder, 2, *expected)


def test_out_that_is_a_file(motor_folder: Make) -> None:
    folder = motor_folder()
    (folder / "out").touch()
    check_refused(folder, 2, f"--out {folder / 'out'}", "is a file; expected a folder")


def test_numbers_that_fail(motor_folder: Make, edit: Edit) -> None:
    """A motor that runs away faster than any window is short."""
    folder = motor_folder()
    edit(folder / "my_motor.py", "p.k * u.voltage - p.b * x.speed", "p.k * u.voltage + 1e9 * p.b * x.speed")
    check_refused(folder, 3, "estimating Motor", "overflows", "try")


def check_refused(folder: Path, code: int, *expected: str, options: Any = ()) -> None:
    """The exit code, one message with all that is expected in it, no traceback, nothing printed or written."""
    before = sorted(folder.rglob("*"))
    result = fit(folder, "--json", *options)
    assert result.exit_code == code
    assert isinstance(result.exception, SystemExit)
    assert result.stdout == ""
    assert result.stderr.startswith("error: " if code == 2 else "the numbers failed: ")
    assert result.stderr.count("\n") == 1
    for text in expected:
        assert text in result.stderr
    assert [p for p in sorted(folder.rglob("*")) if "__pycache__" not in p.parts] == before
