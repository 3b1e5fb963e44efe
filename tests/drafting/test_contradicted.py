"""Units that the name of a column contradicts: which are told, and how the commands tell them."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

import greybox_torch as gt
from greybox_torch.cli import app
from greybox_torch.drafting.contradicted import contradictions
from tests.documentation.pages import ROOT

CARD = """
{time}
[channels]
{channels}
[[experiment]]
name = "run"
file = "run.csv"
"""
TOLD = {
    'time = { column = "time_s", unit = "ms" }': ("s", "ms"),
    'time = { column = "t [s]", unit = "ms" }': ("s", "ms"),
    'time = { column = "t(s)", unit = "us" }': ("s", "us"),
    'time = "millis"': ("ms", "s"),
    'a = { column = "n_motor_rpm", unit = "rad/s" }': ("rpm", "rad/s"),
    'a = { column = "n_rpm", unit = "rad/s", file_unit = "deg/s" }': ("rpm", "deg/s"),
    'a = { column = "n_rpm", unit = "rev" }': ("rpm", "rev"),
    'a = { column = "angle (deg)", unit = "rad" }': ("deg", "rad"),
    'a = { column = "Pendelwinkel [°]", unit = "m" }': ("°", "m"),
    'a = { column = "angle (deg)", unit = "N" }': ("deg", "N"),
    'a = { column = "q_deg", unit = "rad/s", derivative = 5.0 }': ("deg", "rad/s"),
    'a = { column = "i_A", unit = "V" }': ("A", "V"),
    'a = { column = "torque_Nm", unit = "rad" }': ("N m", "rad"),
    'a = { column = "rope_force_kN", unit = "N" }': ("kN", "N"),
    'a = { column = "M_knm", unit = "N m" }': ("kN m", "N m"),
    'a = { column = "p_MPa", unit = "Pa" }': ("MPa", "Pa"),
    'a = { column = "p_Pa", unit = "bar" }': ("Pa", "bar"),
    'a = { column = "level_cm", unit = "m" }': ("cm", "m"),
    'a = { column = "speed_kmh", unit = "m/s" }': ("km/h", "m/s"),
    'a = { column = "drive_power_MW", unit = "kW" }': ("MW", "kW"),
    'a = { column = "x_um", unit = "m/s", derivative = 5.0 }': ("um", "m/s"),
    'a = { column = "T [degC]", unit = "K" }': ("degC", "K"),
    'a = { column = "T [degF]", unit = "degC" }': ("degF", "degC"),
    'a = { column = "T [°F]", unit = "°C" }': ("degF", "°C"),
    'a = { column = "T (deg F)", unit = "degC" }': ("degF", "degC"),
    'a = { column = "T (F)", unit = "degC" }': ("degF", "degC"),
    'a = { column = "T [°C]", unit = "K" }': ("degC", "K"),
    'a = { column = "T (C)", unit = "K" }': ("degC", "K"),
    'a = { column = "T_degF", unit = "degC" }': ("degF", "degC"),
    'a = { column = "T_°F", unit = "degC" }': ("degF", "degC"),
    'a = { column = "T [K]", unit = "degC" }': ("K", "degC"),
    'a = { column = "Drehzahl [U/min]", unit = "rad/s" }': ("U/min", "rad/s"),
    'a = { column = "n / (1/min)", unit = "rad/s" }': ("1/min", "rad/s"),
    'a = { column = "n/U/min", unit = "rad/s" }': ("U/min", "rad/s"),
    'a = { column = "inflow [L/min]", unit = "m^3/s" }': ("L/min", "m^3/s"),
    'a = { column = "Ventilhub/mm", unit = "mm", file_unit = "m" }': ("mm", "m"),
    'a = { column = "speed/(m/s)", unit = "km/h" }': ("m/s", "km/h"),
    'a = { column = "Strom in A", unit = "A", file_unit = "mA" }': ("A", "mA"),
    'a = { column = "Strom/A", unit = "mA" }': ("A", "mA"),
    'a = { column = "LI101 mm", unit = "m" }': ("mm", "m"),
    'a = { column = "SpringTorque [Nmm]", unit = "N m" }': ("Nmm", "N m"),
    'a = { column = "M_Nmm", unit = "N m" }': ("Nmm", "N m"),
    'a = { column = "M (Ncm)", unit = "N m" }': ("Ncm", "N m"),
    'a = { column = "M [kgf cm]", unit = "N m" }': ("kgf cm", "N m"),
    'a = { column = "F [kgf]", unit = "N" }': ("kgf", "N"),
    'a = { column = "speed_kn", unit = "m/s" }': ("kn", "m/s"),
    'a = { column = "v [kts]", unit = "m/s" }': ("kts", "m/s"),
    'a = { column = "v [kn]", unit = "m/s" }': ("kn", "m/s"),
    'a = { column = "alt_ft", unit = "m" }': ("ft", "m"),
    'a = { column = "climb [ft/min]", unit = "m/s" }': ("ft/min", "m/s"),
    'a = { column = "yaw_cdeg", unit = "rad" }': ("cdeg", "rad"),
    'a = { column = "accel_x_g", unit = "m/s^2" }': ("g", "m/s^2"),
    'a = { column = "a [mg]", unit = "m/s^2" }': ("mg", "m/s^2"),
}
SILENT = [
    'a = { column = "pressure in A", unit = "bar" }',  # the chamber
    'a = { column = "strokes/min", unit = "1/s" }',
    'a = { column = "pulses/ms", unit = "1/s" }',
    'a = { column = "T [°C]", unit = "degC" }',
    'a = { column = "T [°]", unit = "degC" }',
    'a = { column = "T (deg)", unit = "K" }',
    'a = { column = "T (C)", unit = "°C" }',
    'a = { column = "T_K", unit = "degC" }',  # a letter alone
    'a = { column = "amplification (K)", unit = "V" }',
    'a = { column = "phase (C)", unit = "V" }',
    'time = { column = "t_ms", unit = "ms" }',
    'time = { column = "time_us", unit = "µs" }',
    'time = { column = "s", unit = "ms" }',  # a name of one letter is no unit
    'a = { column = "n_rpm", unit = "rad/s", file_unit = "rpm" }',
    'a = { column = "n_rpm", unit = "rad/s", scale = 0.10472 }',
    'a = { column = "n_rpm", unit = "1/min" }',
    'a = { column = "n_rpm" }',
    'a = { column = "n [U/min]", unit = "rpm" }',
    'a = { column = "n [U/min]", unit = "1/min" }',
    'a = { column = "Ventilhub/mm", unit = "mm" }',
    'a = { column = "motor/u", unit = "V" }',  # a path
    'a = { column = "motor/V", unit = "mV" }',
    'a = { column = "/imu/mm", unit = "m" }',
    'a = { column = "cold in out", unit = "degC" }',
    'a = { column = "m/s", unit = "km/h" }',
    'a = { column = "rope_force_kN", unit = "N", file_unit = "kN" }',
    'a = { column = "rope_force_kN", unit = "kN" }',
    'a = { column = "position_m", unit = "m" }',
    'a = { column = "x_m", unit = "mm" }',  # measured
    'a = { column = "F_N", unit = "kN" }',  # normal to a surface
    'a = { column = "x_mm", unit = "mm" }',
    'a = { column = "u_V", unit = "V" }',
    'a = { column = "flow_in", unit = "m^3/s" }',
    'a = { column = "u_cm", unit = "V" }',  # common mode
    'a = { column = "force_kn", unit = "m" }',
    'a = { column = "m [g]", unit = "rad" }',
    'a = { column = "a_x_g", unit = "rad/s" }',
    'a = { column = "v_g", unit = "m/s^2" }',
    'a = { column = "accel_x_g", unit = "m/s^2", file_unit = "g" }',
    'a = { column = "flow_ft", unit = "m^3/s" }',
    'a = { column = "force_mn", unit = "N" }',
    'a = { column = "u(t)", unit = "V" }',
    'a = { column = "flow (in)", unit = "m^3/s" }',
    'a = { column = "temp (min)", unit = "degC" }',
    'a = { column = "x_bar", unit = "m" }',
    'a = { column = "heat_rad", unit = "W" }',
    'a = { column = "speed_ma", unit = "rad/s" }',
    'a = { column = "temp_deg", unit = "degC" }',
    'a = { column = "phase_V", unit = "A" }',
    'a = { column = "current_A", unit = "mA" }\nb = { column = "current_B", unit = "mA" }',
    'a = { column = "moment_Nm", unit = "J" }',
    'a = { expr = "0.10472 * n_rpm", unit = "rad/s" }',
]


def written(folder: Path, line: str) -> Path:
    time, channels = (
        (line, 'a = { column = "x", unit = "m" }') if line.startswith("time") else ("sample_time = 1.0", line)
    )
    (folder / "dataset.toml").write_text(CARD.format(time=time, channels=channels))
    return folder / "dataset.toml"


@pytest.mark.parametrize("line", TOLD)
def test_told(tmp_path: Path, line: str) -> None:
    (found,) = contradictions(written(tmp_path, line))
    assert (found.told, found.said) == TOLD[line]
    assert f'column "{line.split(chr(34))[1]}" is in {found.told} by its name, but the card says {found.said}' in str(
        found
    )
    assert found.place == ("time" if line.startswith("time") else 'channel "a"')


@pytest.mark.parametrize("line", SILENT)
def test_not_told(tmp_path: Path, line: str) -> None:
    assert contradictions(written(tmp_path, line)) == []


def test_exchanged_columns_are_told_though_they_have_a_scale(tmp_path: Path) -> None:
    """Seen: the columns of a motor in 1/min and of a belt in m/min, exchanged and scaled, and not a word."""
    lines = (
        'motor = { column = "v_Band [m/min]", unit = "rad/s", scale = 0.105 }',
        'belt = { column = "n_Motor [1/min]", unit = "m/s", scale = 0.0167 }',
    )
    card = tmp_path / "dataset.toml"
    card.write_text(CARD.format(time="sample_time = 0.1", channels="\n".join(lines)), encoding="utf-8")
    found = contradictions(card)
    assert [one.place for one in found] == ['channel "motor"', 'channel "belt"']
    assert found[0].write.startswith('column = "n_Motor [1/min]", which "belt" has: by their names')
    card.write_text(CARD.format(time="sample_time = 0.1", channels=lines[0]), encoding="utf-8")
    assert contradictions(card) == [], "one alone may be measured by means of the other"


def test_of_an_experiments_own_column(tmp_path: Path) -> None:
    card = written(tmp_path, 'a = { column = "x", unit = "rad/s" }')
    card.write_text(card.read_text() + 'columns = { a = "n_rpm" }\n')
    (told,) = contradictions(card)
    assert told.place == '[[experiment]] "run", channel "a"'
    own = 'columns = { a = { column = "n_rpm", %s } } in that [[experiment]]'
    unit, scale = own % 'file_unit = "rpm"', own % "scale = 1.0"
    assert told.write == f"{unit}; or, if the name is wrong, {scale}"
    card = written(tmp_path, 'time = "t"')
    card.write_text(card.read_text() + 'columns = { time = "t_ms" }\n')
    (told,) = contradictions(card)
    assert told.write.startswith(
        'columns = { time = { column = "t_ms", unit = "ms" } } in that [[experiment]], which converts'
    )


def test_no_false_alarm_on_any_card_here() -> None:
    roots = [ROOT / part for part in ("experiments", "greybox_torch", "tests", "docs", "../shared")]
    cards = [card for root in roots for card in root.glob("**/*.toml") if "\n[channels]" in card.read_text()]
    assert len(cards) > 15
    assert {card: found for card in cards if (found := contradictions(card))} == {}


@pytest.fixture
def contradicted(motor_folder: Callable[..., Path]) -> Path:
    """A card whose speed is in rad/s, from a column called `w_rpm`."""
    card = motor_folder() / "dataset.toml"
    for file in card.parent.glob("*.csv"):
        file.write_text(file.read_text().replace("v,w", "v,w_rpm", 1))
    card.write_text(card.read_text().replace('column = "w"', 'column = "w_rpm"'))
    return card


FOUND = 'channel "speed": column "w_rpm" is in rpm by its name, but the card says rad/s'


@pytest.mark.parametrize("command", ["check", "inspect"])
def test_before_anything_is_estimated(contradicted: Path, tmp_path: Path, command: str) -> None:
    out = ["--out", str(tmp_path / "out")] if command == "inspect" else []
    done = CliRunner().invoke(app, [command, str(contradicted), *out])
    assert done.exit_code == 0, done.output
    assert "warning: " in done.stdout and f"dataset.toml: {FOUND}" in done.stdout
    assert 'file_unit = "rpm"' in done.stdout


def test_in_json(contradicted: Path, tmp_path: Path) -> None:
    done = CliRunner().invoke(app, ["inspect", str(contradicted), "--json", "--out", str(tmp_path / "out")])
    assert json.loads(done.stdout)["warnings"][0].startswith(FOUND)
    assert gt.check(gt.load_dataset(contradicted).model or "", gt.load_dataset(contradicted)).findings[0].found == FOUND


def test_a_command_that_estimates_warns(contradicted: Path, tmp_path: Path) -> None:
    """Where `fit` and `diagnose` read what they are given."""
    done = CliRunner().invoke(app, ["simulate", str(contradicted), "--out", str(tmp_path / "out")])
    assert done.exit_code == 0, done.output
    assert f"warning: {contradicted}: {FOUND}" in done.stderr


@pytest.mark.parametrize(
    ("clock", "told"),
    [
        ('column = "stamp_ms", offset = 0.5', ['{ column = "stamp_ms", unit = "ms", offset = 0.5 }']),
        ('column = "stamp_ms", unit = "s"', []),
        ('column = "stamp_s"', []),
        ("offset = 0.5", []),
    ],
)
def test_the_clock_of_a_joined_file(tmp_path: Path, clock: str, told: list[str]) -> None:
    card = tmp_path / "dataset.toml"
    run = f'[[experiment]]\nname = "A"\nfile = ["a.csv", "b.csv"]\njoin = "time"\nclocks = {{ "b.csv" = {{ {clock} }} }}\n'
    card.write_text(f'time = "t"\n[channels]\nu = {{ column = "u", unit = "V" }}\n{run}')
    found = contradictions(card)
    assert [one.write for one in found] == [f'clocks = {{ "b.csv" = {one} }} in that [[experiment]]' for one in told]
    assert all(one.place == '[[experiment]] "A", clocks, "b.csv"' for one in found)
