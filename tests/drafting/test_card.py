"""Cards that are drafted load at once where names tell enough, and say what is missing where they do not."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import scipy.io
from typer.testing import CliRunner

import greybox_torch as gt
from greybox_torch.cli import app

N = 100
T = 0.02 * np.arange(N)
V, W = np.sin(T), np.cos(3 * T)


@pytest.fixture
def folder(tmp_path: Path, machines: Path) -> Path:
    (tmp_path / "my_motor.py").write_text((machines / "motor.py").read_text())
    (tmp_path / "slide.py").write_text((machines / "small.py").read_text())
    return tmp_path


def csv(path: Path, names: str, *columns: np.ndarray, units: str = "") -> Path:
    rows = [",".join(f"{v:.9g}" for v in row) for row in np.column_stack(columns)]
    path.write_text("\n".join([names, *([units] if units else []), *rows]) + "\n")
    return path


FORMATS: dict[str, tuple[str, Callable[[Path], object], dict[str, str]]] = {
    "csv": ("a.csv", lambda p: csv(p, "time,voltage,speed", T, V, W), {"voltage": "voltage", "speed": "speed"}),
    "other words": ("a.csv", lambda p: csv(p, "t,u,w,temp", T, V, W, W), {"voltage": "u", "speed": "w"}),
    "as logged": (
        "a.csv", lambda p: csv(p, "Time (s),MotorVoltage_meas,MotorSpeed_meas", T, V, W),
        {"voltage": "MotorVoltage_meas", "speed": "MotorSpeed_meas"},
    ),
    "by unit": (
        "a.csv", lambda p: csv(p, "t,speed_a,speed_b,voltage", T, V, W, V, units="s,m/s,rad/s,V"),
        {"voltage": "voltage", "speed": "speed_b"},
    ),
    "npz": ("a.npz", lambda p: np.savez(p, speed=W, voltage=V, Ts=0.02), {"voltage": "voltage", "speed": "speed"}),
    "structure": (
        "a.mat", lambda p: scipy.io.savemat(p, {"log": {"t": T, "motor": {"speed": W, "voltage": V}}}),
        {"voltage": "log.motor.voltage", "speed": "log.motor.speed"},
    ),
}  # fmt: skip


@pytest.mark.parametrize("form", FORMATS)
def test_a_card_loads_at_once(folder: Path, form: str) -> None:
    name, write, channels = FORMATS[form]
    write(folder / name)
    done = CliRunner().invoke(app, ["card", str(folder / name), "--model", f"{folder / 'my_motor.py'}:Motor"])
    assert done.exit_code == 0, done.output
    assert "To be filled in" not in done.stdout
    data = gt.load_dataset(folder / "dataset.toml")
    assert [(len(r), r.role) for r in data.recordings] == [(75, "estimation"), (25, "validation")]
    assert data.recordings[0].sample_time == pytest.approx(0.02)
    text = (folder / "dataset.toml").read_text()
    for channel, column in channels.items():
        assert f'{channel} = {{ column = "{column}"' in text
    inspected = CliRunner().invoke(app, ["inspect", str(folder / "dataset.toml"), "--out", str(folder / "out")])
    assert inspected.exit_code == 0, inspected.output
    assert "fit the model" in inspected.stdout


def test_a_unit_at_the_end_of_a_name_is_no_part_of_the_name(folder: Path) -> None:
    csv(folder / "a.csv", "t,speed_coil_rpm,speed_rpm,speed_deg,U_bus_mV", T, W, W, W, 1e3 * V)
    card = gt.card(folder / "a.csv", f"{folder / 'my_motor.py'}:Motor")
    assert (
        'speed = { column = "speed_rpm", unit = "rad/s", file_unit = "rpm" }    # converted from the unit that the file says\n'
        in card.text
    )
    assert (
        'column = "U_bus_mV", unit = "V", file_unit = "mV" }    # converted from the unit that the file says; please check'
        in card.text
    )


def test_a_column_that_is_not_found_is_told_with_those_left_over(folder: Path) -> None:
    csv(folder / "a.csv", "t,speed,wind_degF", T, W, W)
    card = gt.card(folder / "a.csv", f"{folder / 'my_motor.py'}:Motor")
    constant = "or, of a constant, no column and constants = { voltage = … } in every [[experiment]]"
    assert f"[channels] voltage: no column fits; left over: wind_degF; {constant}" in card.open


def test_units_of_the_file_are_converted(folder: Path) -> None:
    csv(folder / "a.csv", "t [ms],voltage [mV],speed [rpm]", 1e3 * T, 1e3 * V, W * 30 / np.pi)
    gt.card(folder / "a.csv", f"{folder / 'my_motor.py'}:Motor").save()
    data = gt.load_dataset(folder / "dataset.toml")
    assert data.recordings[0].sample_time == pytest.approx(0.02)
    np.testing.assert_allclose(data.recordings[0].signals["speed"], W[:75], atol=1e-6)
    np.testing.assert_allclose(data.recordings[0].signals["voltage"], V[:75], atol=1e-6)


@pytest.mark.parametrize(("header", "refused"), [("1/min", False), ("U/min", False), ("1/s", True)])
def test_turns_per_minute_are_not_converted_to_themselves(folder: Path, header: str, refused: bool) -> None:
    """Whether 1/s counts turns or radians is asked rather than guessed."""

    class Stirrer(gt.GreyBoxModel):
        states = [gt.State("speed", "rpm")]
        inputs, outputs = [gt.Input("voltage", "V")], [gt.Output("speed", "rpm")]

    csv(folder / "a.csv", f"t,voltage,speed [{header}]", T, V, W)
    gt.card(folder / "a.csv", Stirrer()).save()
    if refused:
        with pytest.raises(gt.UserError, match='"1/s" beside "rpm" may count turns or radians'):
            gt.load_dataset(folder / "dataset.toml")
    else:
        np.testing.assert_allclose(gt.load_dataset(folder / "dataset.toml").recordings[0].signals["speed"], W[:75])


def test_words_of_other_languages_and_the_only_column_left(folder: Path) -> None:
    """A German log: the voltage by its word, the speed by its word and turns a minute, or by nothing but its unit."""
    for names in ("Zeit [s],Spannung [V],Drehzahl [1/min]", "Zeit [s],Spannung [V],Kanal7 [1/min]"):
        csv(folder / "a.csv", names, T, V, W * 30 / np.pi)
        gt.card(folder / "a.csv", f"{folder / 'my_motor.py'}:Motor", path=folder / "own.toml").save()
        data = gt.load_dataset(folder / "own.toml")
        np.testing.assert_allclose(data.recordings[0].signals["speed"], W[:75], atol=1e-6)
        np.testing.assert_allclose(data.recordings[0].signals["voltage"], V[:75], atol=1e-6)
        (folder / "own.toml").unlink()


def test_sizes_give_a_slip_away(folder: Path) -> None:
    """A speed in rpm beside a position in rad; nothing is converted without being asked for."""

    class Arm(gt.GreyBoxModel):
        states = [gt.State("angle", "rad"), gt.State("speed", "rad/s")]
        inputs, outputs = [], [gt.Output("angle", "rad"), gt.Output("speed", "rad/s")]
        ports = [gt.Body("arm", speed="speed", position="angle")]

    csv(folder / "a.csv", "t,angle,speed", T, np.sin(3 * T), 3 * np.cos(3 * T) * 30 / np.pi)
    drafted = gt.card(folder / "a.csv", Arm())
    assert {row["channel"]: row["remark"] for row in drafted.rows} == {
        "angle": "",
        "speed": 'its size suggests rpm: add file_unit = "rpm"',
    }
    csv(folder / "b.csv", "t,angle,speed", T, np.sin(3 * T), 3 * np.cos(3 * T))
    assert all(row["remark"] == "" for row in gt.card(folder / "b.csv", Arm()).rows)


def test_several_files_and_columns_of_their_own(folder: Path) -> None:
    csv(folder / "a.csv", "t,voltage,speed", T, V, W)
    csv(folder / "b.csv", "time,u,speed", T, V, W)
    csv(folder / "c.csv", "t,voltage,speed", T, V, W)
    gt.card([folder / f"{k}.csv" for k in "abc"], f"{folder / 'my_motor.py'}:Motor").save()
    data = gt.load_dataset(folder / "dataset.toml")
    assert [r.role for r in data.recordings] == ["estimation", "estimation", "validation"]
    np.testing.assert_allclose(data.recordings[1].signals["voltage"], V, atol=1e-8)


def test_what_is_not_found_is_left_to_fill_in(folder: Path) -> None:
    csv(folder / "a.csv", "first,second", V, W)
    done = CliRunner().invoke(
        app, ["card", str(folder / "a.csv"), "--model", f"{folder / 'my_motor.py'}:Motor", "--json"]
    )
    assert done.exit_code == 0
    told = json.loads(done.stdout)
    assert told["schema"] == "greybox-card/1"
    assert [row["column"] for row in told["channels"]] == [None, None]
    assert len(told["open"]) == 3
    card = folder / "dataset.toml"
    text = card.read_text()
    assert "# also in a.csv: first, second" in text
    filled = text.replace("# sample_time = 0.001", "sample_time = 0.02")
    for channel, column in (("voltage", "first"), ("speed", "second")):
        filled = filled.replace(f'# {channel} = {{ column = "…"', f'{channel} = {{ column = "{column}"')
    card.write_text(filled)
    assert len(gt.load_dataset(card).recordings) == 2


def test_without_a_model_and_from_elsewhere(folder: Path) -> None:
    csv(folder / "a.csv", 't,Motor Voltage [V],2nd speed,"no.thing"', T, V, W, W)
    done = CliRunner().invoke(app, ["card", str(folder / "a.csv"), "--out", str(folder / "cards" / "one.toml")])
    assert done.exit_code == 0, done.output
    data = gt.load_dataset(folder / "cards" / "one.toml")
    assert list(data.channels) == ["motor_voltage", "channel_2_nd_speed", "thing"]
    assert data.channels["motor_voltage"].unit == "V"
    drawn = gt.card(folder / "a.csv").plot().axes
    assert len(drawn) == 3 and drawn[-1].get_xlabel() == "sample"


def test_the_sample_time_may_be_given(folder: Path) -> None:
    csv(folder / "a.csv", "voltage,speed", V, W)
    done = CliRunner().invoke(app, ["card", str(folder / "a.csv"), "--sample-time", "0.5"])
    assert done.exit_code == 0
    assert gt.load_dataset(folder / "dataset.toml").recordings[0].sample_time == 0.5
    with pytest.raises(gt.UserError, match="sample_time: found -1"):
        gt.card(folder / "a.csv", sample_time=-1)


def test_nothing_is_overwritten(folder: Path) -> None:
    csv(folder / "a.csv", "t,voltage,speed", T, V, W)
    (folder / "dataset.toml").write_text("mine")
    done = CliRunner().invoke(app, ["card", str(folder / "a.csv")])
    assert done.exit_code == 2
    assert "is there already and is not overwritten" in done.stderr
    assert (folder / "dataset.toml").read_text() == "mine"
    assert sorted(p.name for p in folder.iterdir()) == ["a.csv", "dataset.toml", "my_motor.py", "slide.py"]


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("none.csv", None, "no such file"),
        ("empty.csv", "", "is empty (0 bytes); expected a recording"),
        ("words.csv", "a,b\nc,d\n", "no line of numbers"),
        ("a.xyz", "1", 'no reader for files ending in ".xyz"'),
        ("a.npz", "1", "not a NumPy archive"),
    ],
)
def test_files_that_are_no_recordings(folder: Path, name: str, content: str | None, message: str) -> None:
    if content is not None:
        (folder / name).write_text(content)
    done = CliRunner().invoke(app, ["card", str(folder / name)])
    assert done.exit_code == 2
    assert message in done.stderr
    assert not (folder / "dataset.toml").exists()


def test_of_a_column_of_dates_no_unit_is_told_that_the_file_does_not_have(folder: Path) -> None:
    """Seen: "the file says s" beside dates. They are read in seconds."""
    rows = [f"2026-11-23 10:00:{k:02d};{v:.6g};{w:.6g}" for k, v, w in zip(range(60), V, W, strict=False)]
    (folder / "dates.csv").write_text("\n".join(["Zeitstempel;voltage;speed", *rows]) + "\n")
    done = CliRunner().invoke(app, ["card", str(folder / "dates.csv"), "--model", f"{folder / 'my_motor.py'}:Motor"])
    assert done.exit_code == 0, done.output
    card = (folder / "dataset.toml").read_text()
    assert "read in s; steps of 1 s" in card and "the file says s" not in card


def test_steps_of_dates_have_no_digits_that_the_dates_do_not_hold(folder: Path) -> None:
    """Seen: "steps of 0.00200009 s" of dates that are 2 ms apart, as seconds since 1970 are multiples of 0.24 µs."""
    rows = [f"2025-03-04T10:15:02.{2 * k:03d},{v:.6g},{w:.6g}" for k, v, w in zip(range(100), V, W, strict=True)]
    (folder / "dates.csv").write_text("\n".join(["Timestamp,voltage,speed", *rows]) + "\n")
    assert "steps of 0.002 s" in gt.card(folder / "dates.csv").text
