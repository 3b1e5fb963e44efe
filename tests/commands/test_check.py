"""`greybox check`: what is printed, as JSON too, and how it ends."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

import greybox_torch as gt
from greybox_torch.cli import app


def test_a_sound_model_ends_with_0(machines: Path) -> None:
    done = CliRunner().invoke(app, ["check", f"{machines / 'motor.py'}:Motor"])
    assert done.exit_code == 0, done.output
    assert "motor.py:Motor can be used; nothing is wrong with it that shows without data." in done.stdout
    rows = [line.split() for line in done.stdout.splitlines()]
    assert ["port", "rotor", "speed"] in rows
    assert ["input", "voltage", "V", "speed"] in rows


def test_a_card_that_fits_is_said_to(motor_folder: Callable[..., Path]) -> None:
    """Seen: "motor.py:Motor can be used", of a card; nothing was said of it, though it had been compared with the model."""
    card = motor_folder() / "dataset.toml"
    done = CliRunner().invoke(app, ["check", str(card)])
    assert done.exit_code == 0, done.output
    fits = "Channels, parameters and start states of dataset.toml fit "
    closing = next(line for line in done.stdout.splitlines() if line.startswith(fits))
    assert ", which can be used" in closing
    data = gt.load_dataset(card)
    assert gt.check(data.model, data).sentence == closing


def test_findings_end_with_2(motor_folder: Callable[..., Path], edit: Callable[[Path, str, str], None]) -> None:
    folder = motor_folder()
    edit(folder / "my_motor.py", "p.b * x.speed", "p.c * x.speed")
    done = CliRunner().invoke(app, ["check", str(folder / "dataset.toml"), "--json"])
    assert done.exit_code == 2
    told = json.loads(done.stdout)
    assert told["schema"] == "greybox-check/1"
    assert told["usable"] is False
    assert [f["level"] for f in told["findings"]] == ["error"]
    assert told["findings"][0]["file"] == str(folder / "my_motor.py")
    assert (folder / "my_motor.py").read_text().splitlines()[told["findings"][0]["line"] - 1].count("p.c") == 1
    assert "error: my_motor.py, line" in done.stderr


def test_a_card_that_does_not_fit(motor_folder: Callable[..., Path], edit: Callable[[Path, str, str], None]) -> None:
    card = motor_folder() / "dataset.toml"
    assert CliRunner().invoke(app, ["check", str(card)]).exit_code == 0
    edit(card, "b = { value = 0.08, upper = 1.0 }", "bb = { value = 0.08 }")
    done = CliRunner().invoke(app, ["check", str(card)])
    assert done.exit_code == 2
    assert "error: dataset.toml:" in done.stdout
    assert "model Motor has no such name" in done.stdout


def test_a_folder_is_answered_with_its_card(motor_folder: Callable[..., Path]) -> None:
    """Seen: "model '.' is unknown; expected a built-in system", where `greybox fit .` names the card."""
    folder = motor_folder()
    done = CliRunner().invoke(app, ["check", str(folder)])
    assert done.exit_code == 2
    assert f"{folder}: is a folder; expected the card in it, {folder / 'dataset.toml'}" in done.stderr


BOUNDS = "Parameter 'b': value -1 lies outside its bounds [0, inf]"
SENSOR = 'a line such as speed = { column = "…", unit = "rad/s" }; an output that no sensor shows is left out of the model\'s outputs'


@pytest.mark.parametrize(
    ("old", "new", "found", "write"),
    [
        ("b = { value = 0.08, upper = 1.0 }", "b = { value = -1.0 }", BOUNDS, "a value within the bounds"),
        ("speed = {", "wheel = {", "[channels] has no 'speed', which model Motor needs; found: voltage, wheel", SENSOR),
        ('unit = "V"', 'unit = "A"', "A cannot be converted to V", "a column whose values are in V"),
        ('unit = "V"', 'unit = "mV"', "unit is 'mV'", 'unit = "V" with file_unit = "mV"'),
        ('unit = "V"', 'unit = "digits"', "unit is 'digits'", "where the file is in another unit"),
    ],
)
def test_a_wrong_card_is_told_what_to_write(
    motor_folder: Callable[..., Path],
    edit: Callable[[Path, str, str], None],
    old: str,
    new: str,
    found: str,
    write: str,
) -> None:
    """Seen: advice to write "the names that the model declares" for a value, and to convert volts to ampere."""
    card = motor_folder() / "dataset.toml"
    edit(card, old, new)
    done = CliRunner().invoke(app, ["check", str(card)])
    assert done.exit_code == 2
    error, advice, closing = done.stdout.splitlines()[-3:]
    assert error.startswith("error: dataset.toml: ") and found in error
    assert advice.startswith("    write: ") and write in advice
    assert closing == "dataset.toml does not fit my_motor.py:Motor, which itself can be used: 1 error."


@pytest.mark.parametrize(
    ("table", "told"),
    [
        (
            "[limits]\nvoltag = { lower = -5, upper = 5 }",
            '[limits] voltag: no input, output or state is named so (did you mean "voltage"?)',
        ),
        ("[limits]\nvoltage = { lower = 5, upper = -5 }", "[limits] voltage: lower = 5 is not below upper = -5"),
        (
            "[limits]\nvoltage = { range = [-5, 5] }",
            '[limits] voltage: found {"range": [-5, 5]}, which `greybox design` refuses\n'
            "    write: { lower = …, upper = …, rate = … }, or some of these",
        ),
        ('[beliefs]\n"roter/*" = 0.0', '[beliefs]: "roter/*": model Motor has no port "roter" (did you mean "rotor"?)'),
        (
            '[beliefs]\n"rotor/*" = 1.0',
            '[beliefs]: "rotor/*": found 1.0, which `greybox diagnose` refuses\n'
            "    write: 'unlikely', 'likely', or a probability from 0 (excluded) to below 1",
        ),
        ("[diagnosis]\nleast_gian = 0.1", '[diagnosis]: "least_gian" is not a setting (did you mean "least_gain"?)'),
    ],
)
def test_what_later_commands_would_refuse_of_the_card(motor_folder: Callable[..., Path], table: str, told: str) -> None:
    """Seen: [limits] with a misspelt input; nothing said so until the next recording was designed. `inspect` tells the same."""
    card = motor_folder() / "dataset.toml"
    card.write_text(f"{card.read_text()}\n{table}\n")
    done = CliRunner().invoke(app, ["check", str(card)])
    assert done.exit_code == 2
    assert f"error: dataset.toml: {told}" in done.stdout
    assert "dataset.toml does not fit my_motor.py:Motor, which itself can be used: 1 error." in done.stdout
    looked = CliRunner().invoke(app, ["inspect", str(card), "--out", str(card.parent / "looked")])
    assert looked.exit_code == 0
    assert f"{card}: {told}".replace("\n    write: ", "; write: ") in looked.stdout


def test_a_wrong_model_cannot_be_used(
    motor_folder: Callable[..., Path], edit: Callable[[Path, str, str], None]
) -> None:
    folder = motor_folder()
    edit(folder / "my_motor.py", "p.b * x.speed", "p.c * x.speed")
    edit(folder / "dataset.toml", "b = { value = 0.08, upper = 1.0 }", "b = { value = -1.0 }")
    done = CliRunner().invoke(app, ["check", str(folder / "dataset.toml")])
    assert done.stdout.splitlines()[-1] == "my_motor.py:Motor cannot be used: 1 error."


def test_parameters_have_the_values_of_the_card(motor_folder: Callable[..., Path]) -> None:
    """Seen: a new user read the values of the model's file as those of a card that is not applied."""
    folder = motor_folder()
    shown = [
        CliRunner().invoke(app, ["check", str(t)]) for t in (folder / "dataset.toml", f"{folder / 'my_motor.py'}:Motor")
    ]
    with_card, alone = (
        next(line.split() for line in done.stdout.splitlines() if line.split()[:2] == ["parameter", "b"])
        for done in shown
    )
    assert "0.08" in with_card and "0.08" not in alone


@pytest.mark.parametrize("target", ["no_such.py:Motor", "no_such_system", "no_such.toml"])
def test_what_is_not_there(target: str) -> None:
    done = CliRunner().invoke(app, ["check", target])
    assert done.exit_code == 2
    assert done.stdout == ""
    assert done.stderr.startswith("error: ")


def test_a_card_without_a_model(bench: Path) -> None:
    done = CliRunner().invoke(app, ["check", str(bench / "dataset.toml")])
    assert done.exit_code == 2
    assert "no --model is given" in done.stderr


def test_from_python(machines: Path) -> None:
    model = gt.load_model(f"{machines / 'small.py'}:WarmRotor")
    found = gt.check(model)
    assert found.usable
    assert found.compiled
    assert "1 note" in found.sentence
    assert gt.check(type(model)).to_json() == found.to_json()
    assert {(row["kind"], row["name"]): row["moves"] for row in found.rows}["state", "warmth"] == []
    assert "warmth" in found._repr_html_() and '<td class="number">' in found._repr_html_()
    assert len(found.plot().axes) == 1
    assert found.save("anywhere") == ()
    with pytest.raises(gt.UserError, match="expected a model, its class, or its name"):
        gt.check(3)  # type: ignore[arg-type]


def test_built_in() -> None:
    assert gt.check("robot_arm").findings == ()


def test_a_value_of_the_card_that_the_equations_divide_by(
    motor_folder: Callable[..., Path], edit: Callable[[Path, str, str], None]
) -> None:
    """Seen: an inertia of zero on the card, "can be used", and no simulation."""
    card = motor_folder() / "dataset.toml"
    edit(card, "J = { value = 0.03 }", "J = { value = 0.0 }")
    done = CliRunner().invoke(app, ["check", str(card)])
    assert "error: my_motor.py, line 20: the equations give no number at the start" in done.stdout
    assert "where J = 0" in done.stdout and "a value of J other than zero" in done.stdout


def test_a_mass_that_a_card_makes_negative(
    motor_folder: Callable[..., Path], edit: Callable[[Path, str, str], None]
) -> None:
    card = motor_folder() / "dataset.toml"
    edit(card, "J = { value = 0.03 }", "J = { value = -0.03, lower = -1.0 }")
    told = CliRunner().invoke(app, ["check", str(card)]).stdout
    assert "J begins at -0.03 kg m^2: with a negative inertia a model runs away" in told
