"""What `fit` refuses: one message, nothing printed, nothing written."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.commands.fitting import Edit, Make, fit


@pytest.mark.parametrize("name", ["bb", "k"])
def test_profiles_that_are_refused(motor_folder: Make, name: str) -> None:
    said = {"bb": 'no parameter of that name (did you mean "b"?)', "k": "this parameter is fixed"}[name]
    check_refused(motor_folder(), 2, f"--profile {name}: ", said, "J, b", options=("--profile", name))


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
        ["[model.initial] spede", 'did you mean "speed"'],
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
        ('speed="speed"', 'speed="sped"', ["my_motor.py, class Motor: port 'rotor': speed = \"sped\" is not a state"]),
        ("u.voltage", "u.volts", ["my_motor.py, class Motor, line ", "the input 'volts'", "declared: voltage"]),
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
