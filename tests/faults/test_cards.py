"""Faults in cards: what was changed in a sound one, and the answer."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

U = 'voltage = { column = "u", unit = "V" }'
J = "J = { value = 0.02 }"
A = 'file = "a.csv"\nrole = "estimation"'
TOP = "sample_time = 0.01"

FAULTS = [
    (TOP, "", '"sample_time" is missing'),
    (TOP, "sample_time = 0", "sample_time: 0 is not a sample time"),
    (TOP, "sample_time = -1e-3", "sample_time: -0.001 is not a sample time"),
    (TOP, "sample_time = nan", "sample_time: found NaN, expected a finite number"),
    (TOP, "sample_time = 0,01", "sample_time = 0,01; expected a decimal point, as in 0.02"),
    (TOP, TOP + "\nx = { value = -0,02 }", "x = { value = -0,02 }; expected a decimal point"),
    (TOP, "sample_time = inf", "sample_time: found Infinity, expected a finite number"),
    (TOP, "sample_time = 1e400", "sample_time: found Infinity"),
    (TOP, "sample_time = 1e308", "sample_time: 1e+308 s makes times that are no numbers"),
    (TOP, 'sample_time = "1 ms"', 'sample_time: found "1 ms", expected a number'),
    (TOP, "sample_time = true", "sample_time: found true, expected a number"),
    (TOP, "sample_time = [0.01]", "sample_time: found [0.01], expected a number"),
    (TOP, "sample_time = 2026-11-21", "sample_time: found"),
    (TOP, "sample_time = 0.01\nsample_time = 0.01", "not valid TOML: Cannot overwrite a value"),
    (TOP, "sample_time = 0.01\ntime = 't'", 'both "sample_time" and "time" are given'),
    (TOP, "time = 't'", 'no column "t"'),
    (TOP, "time = ''", "expected the name of a column"),
    (TOP, "time = 7", "no column #7"),
    (TOP, "time = { column = 't', unit = 'weeks' }", 'time, unit: found "weeks"'),
    (TOP, TOP + "\ndecimate = 0", "decimate: found 0, expected at least 2"),
    (TOP, TOP + "\ndecimate = 99999999", "expected at most 10000"),
    (TOP, TOP + "\ndecimate = 60", "has 2 samples; expected at least 10"),
    (TOP, TOP + "\nresample = 0.1", '"resample" is of time stamps'),
    (TOP, TOP + "\nx = " + "9" * 5000, "not valid TOML: Exceeds the limit"),
    (TOP, TOP + "\ndecimate = 0x" + "f" * 5000, "decimate: found"),
    (TOP, "sample_time = 0x" + "f" * 5000, "sample_time: found"),
    (TOP, TOP + "\nx = " + "[" * 20000, "nested too deeply"),
    (TOP, TOP + "\nx = " + "[" * 300 + "]" * 300, 'unknown key "x"'),
    (TOP, TOP + "\nx = " + "{a=" * 5000, "nested too deeply"),
    (TOP, TOP + "\n" + ".".join("a" * 3000) + " = 1", "dataset.toml"),
    (TOP, TOP + "\nsmaple_time = 1", 'unknown key "smaple_time" (did you mean "sample_time"?)'),
    ('hold = "zoh"', 'hold = "linear"', 'hold: found "linear", expected "zoh" (held'),
    ('hold = "zoh"', "hold = 1", "hold: found 1"),
    ('name = "Bench"', 'name = ""', 'name: found "", expected text that is not empty'),
    ('name = "Bench"', "name = 3", "name: found 3, expected text in quotes"),
    ('name = "Bench"', 'name = "unclosed', "not valid TOML"),
    ('name = "Bench"', "\0", "not valid TOML"),
    (U, 'voltage = "u"', '[channels], voltage: found "u", expected a table'),
    (U, 'voltage = { unit = "V" }', '[channels], voltage: "column" is missing'),
    (U, 'voltage = { column = "u", expr = "u" }', 'both "column" and "expr" are given'),
    (U, 'voltage = { column = "U", unit = "V" }', 'no column "U" (did you mean "u"?); found u, y'),
    (U, 'voltage = { column = "", unit = "V" }', "expected the name of a column"),
    (U, "voltage = { column = -1 }", "-1 is not a column"),
    (U, 'voltage = { column = "u", unit = "V", scale = 0 }', "a scale of zero would erase the channel"),
    (U, 'voltage = { column = "u", unit = "V", scale = nan }', "scale: found NaN"),
    (U, 'voltage = { column = "u", unit = "V", scale = 1e300 }', "once scaled: found"),
    (U, 'voltage = { column = "u", unit = "V", file_unit = "rpm" }', 'cannot be converted to "V"'),
    (U, 'voltage = { column = "u", unit = "V", file_unit = "9**9**9**9" }', 'cannot convert "9**9**9**9"'),
    (U, 'voltage = { expr = "__import__(\'os\').abort()", unit = "V" }', "is not understood"),
    (U, 'voltage = { expr = "u / (u - u)", unit = "V" }', "is no number at sample 0"),
    (U, 'voltage = { expr = "9**9**9**9 * u", unit = "V" }', "is no number at sample 0"),
    (U, f'voltage = {{ expr = "{"(" * 240}u{")" * 240}", unit = "V" }}', "not an expression"),
    (U, 'voltage = { column = "u", unit = "mV" }', "[channels] voltage: unit is 'mV', model Motor expects 'V'"),
    (U, U + "\n" + U, "not valid TOML"),
    (U, U + '\ntorque = { column = "u" }', "[channels] torque: model Motor has no such signal"),
    (U, U + '\ntime = { column = "u" }', '"time" cannot name a channel'),
    (U, "", "[channels] has no 'voltage', which model Motor needs"),
    (A, "file = 'b.csv'", "b.csv: no such file (did you mean"),
    (A, "file = ''", "expected text that is not empty"),
    (A, "file = '.'", "is a folder; expected a recording in it"),
    (A, "file = '/dev/zero'", "no reader for files ending in"),
    (A, "file = 'a.xlsx'", 'no reader for files ending in ".xlsx"'),
    (A, 'file = "a\\u0000.csv"', "expected text without control characters"),
    ('name = "A"', 'name = " "', "expected a name that can be seen"),
    (A, f"file = '{'x' * 300}.csv'", "cannot be read: File name too long"),
    (A, "file = 3", "file: found 3, expected the name of a file, or a list of names"),
    (A, "file = []", "expected the name of a file"),
    (A, "file = ['a.csv', 'a.csv']", 'several files are given without "join"'),
    (A, "file = ['a.csv', 'a.csv']\njoin = 'time'", 'join = "time" needs time stamps'),
    (A, "file = 'a.csv'\njoin = 'append'", "join: found \"append\", expected 'concatenate', 'time' or 'rows'"),
    (A, A + '\ncolumns = { volt = "u" }', 'no channel is named "volt" (did you mean "voltage"?)'),
    (A, A + '\ncolumns = { time = "t" }', '"time" needs time ='),
    (A, A + "\ncolumns = { voltage = 3 }", "no column #3"),
    (A, A + '\ncolumns = "u"', "columns: found"),
    (A, A + "\nrows = [0, 81]", "rows: found [0, 81], expected 0 <= start < stop <= 80"),
    (A, A + "\nrows = [-1, 20]", "rows: found [-1, 20]"),
    (A, A + "\nrows = [20, 20]", "rows: found [20, 20]"),
    (A, A + "\nrows = [0, 9]", "has 9 samples; expected at least 10"),
    (A, A + "\nrows = [0]", "expected two whole numbers, [start, stop]"),
    (A, A + "\nrows = [0.5, 20]", "found 0.5, expected a whole number"),
    (A, A + f"\nrows = [0, {10**30}]", "rows"),
    (A, A.replace("estimation", "test"), "role: found \"test\", expected 'estimation' or 'validation'"),
    ('name = "A"', "", '[[experiment]] 1: "name" is missing'),
    ('name = "A"', 'name = "B"', '2 experiments are named "B"'),
    ("[[experiment]]", "[experiment]", "dataset.toml"),
    (J, "J = 0.02", "[model.parameters], J: found 0.02, expected a table"),
    (J, "J = { value = inf }", "J, value: found Infinity"),
    (J, "J = { lower = nan }", "J, lower: nan is not a bound"),
    (J, "J = { lower = 1, upper = 0 }", "lower = 1 is not below upper = 0"),
    (J, "J = { value = 2, upper = 1 }", "value = 2 is above upper = 1"),
    (J, "J = { value = -1 }", "[model.parameters]"),
    (J, "J = { fixed = 1 }", "J, fixed: found 1, expected true or false"),
    (J, "JJ = { value = 1 }", "JJ: model Motor has no such name"),
    (J, "J = { valu = 1 }", 'unknown key "valu" (did you mean "value"?)'),
    ("speed = { value = 0.0 }", "speed = { value = nan }", "[model.initial], speed, value: found NaN"),
    ("speed = { value = 0.0 }", "angle = { value = 0.0 }", "angle: model Motor has no such name"),
    ("my_motor.py:Motor", "my_motor.py:Engine", "class 'Engine' is not defined; it defines Motor"),
    ("my_motor.py:Motor", "motor.py:Motor", "motor.py: no such file"),
    ("my_motor.py:Motor", "robot_leg", "model 'robot_leg' is unknown"),
    ("my_motor.py:Motor", "", "[model], name"),
    ("[model]", "[modle]", 'unknown key "modle" (did you mean "model"?)'),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "message"), FAULTS, ids=[f"{k}: {f[1]:.30}" for k, f in enumerate(FAULTS)])
def test_fault(spoilt: Path, answer: Callable[..., str], old: str, new: str, message: str | None) -> None:
    card = spoilt / "dataset.toml"
    assert old in card.read_text()
    card.write_text(card.read_text().replace(old, new, 1))
    answer("inspect", "dataset.toml", code=0 if message is None else 2, message=message or "")


def test_two_experiments_that_would_end_with_one_name(spoilt: Path, answer: Callable[..., str]) -> None:
    card = spoilt / "dataset.toml"
    card.write_text(card.read_text().replace("validation", "estimation").replace('name = "B"', 'name = "A (held out)"'))
    answer("inspect", "dataset.toml", message='2 experiments are named "A (held out)"')


@pytest.mark.parametrize("content", [b"", b"\xff\xfe\x00", b"\x00" * 1000, b"PK\x03\x04", b"[" * 10**6])
def test_no_card_at_all(spoilt: Path, answer: Callable[..., str], content: bytes) -> None:
    (spoilt / "dataset.toml").write_bytes(content)
    answer("inspect", "dataset.toml", message="dataset.toml: ")
