"""What a card can say of files as they come: several of them, units, expressions, time in milliseconds, uneven time stamps."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from greybox_torch.data import DataSet, load_dataset
from greybox_torch.errors import UserError

N = 40
U, Y = np.sin(np.arange(N) / 3), np.cos(np.arange(N) / 3)

Load = Callable[..., DataSet]


@pytest.fixture
def load(tmp_path: Path) -> Load:
    """Writes text files, by name as columns, and a card; and loads it."""

    def make(
        top: str, channels: str, experiment: str = 'file = "a.csv"', **files: dict[str, np.ndarray] | str
    ) -> DataSet:
        for name, content in files.items():
            text = content
            if isinstance(content, dict):
                rows = zip(*content.values(), strict=True)
                text = "\n".join(
                    [",".join(content), *(",".join("" if np.isnan(v) else repr(float(v)) for v in row) for row in rows)]
                )
            (tmp_path / f"{name}.csv").write_text(str(text))
        card = tmp_path / "dataset.toml"
        card.write_text(
            f'{top}\n[channels]\n{channels}\n[[experiment]]\nname = "A"\nrole = "validation"\n{experiment}\n'
        )
        return load_dataset(card)

    return make


TWO = 'u = { column = "u", unit = "V" }\ny = { column = "y", unit = "rad/s" }'


def test_a_time_column_in_milliseconds(load: Load) -> None:
    (a,) = load(
        'time = { column = "t", unit = "ms" }', TWO, a={"t": 7.0 + 2.0 * np.arange(N), "u": U, "y": Y}
    ).recordings
    np.testing.assert_allclose(a.time, 0.007 + 0.002 * np.arange(N), rtol=1e-12)
    assert a.sample_time == pytest.approx(0.002)
    assert a.notes == ()


def test_an_expression_and_units(load: Load) -> None:
    channels = (
        'u = { expr = "0.5 * (i1 - i2)", unit = "A", file_unit = "mA" }\n'
        'y = { column = "w", unit = "rad/s", file_unit = "rpm" }\nz = { column = 4, unit = "m" }'
    )
    (a,) = load("sample_time = 0.01", channels, a={"i1": U, "i2": -Y, "w": Y, "q": U}).recordings
    np.testing.assert_allclose(a.signals["u"], 0.5e-3 * (U + Y))
    np.testing.assert_allclose(a.signals["y"], Y * np.pi / 30)
    np.testing.assert_array_equal(a.signals["z"], U)


def test_an_experiment_can_name_a_column_in_the_place_of_an_expression(load: Load) -> None:
    channels = 'u = { expr = "i1 - i2" }'
    (a,) = load("sample_time = 0.01", channels, 'file = "a.csv"\ncolumns = { u = "i" }', a={"i": U}).recordings
    np.testing.assert_array_equal(a.signals["u"], U)


def test_files_one_after_the_other(load: Load) -> None:
    half = N // 2
    (a,) = load(
        "sample_time = 0.01", TWO, 'file = ["a.csv", "b.csv"]\njoin = "concatenate"\nrows = [5, 35]',
        a={"u": U[:half], "y": Y[:half]}, b={"y": Y[half:], "u": U[half:]},
    ).recordings  # fmt: skip
    np.testing.assert_array_equal(a.signals["u"], U[5:35])
    np.testing.assert_array_equal(a.time, np.arange(5, 35) * 0.01)


def test_a_fault_in_the_second_file_is_told_with_its_line(load: Load) -> None:
    half = N // 2
    with pytest.raises(UserError, match=r'b.csv, line 4, column "y", sample 2 .*: found inf'):
        load(
            "sample_time = 0.01", TWO, 'file = ["a.csv", "b.csv"]\njoin = "concatenate"',
            a={"u": U[:half], "y": Y[:half]}, b="u,y\n1,1\n1,1\n1,inf\n",
        )  # fmt: skip


def test_files_joined_in_time(load: Load) -> None:
    t = np.arange(N) * 0.01
    other = np.arange(0.0, 0.3, 0.004)
    (a,) = load(
        'time = "t"',
        TWO,
        'file = ["a.csv", "b.csv"]\njoin = "time"',
        a={"t": t, "u": U},
        b={"t": other, "y": 3 * other},
    ).recordings
    inside = t <= other[-1]
    np.testing.assert_allclose(a.signals["y"][inside], 3 * t[inside], atol=1e-12)
    assert np.isnan(a.signals["y"][~inside]).all()
    np.testing.assert_array_equal(a.signals["u"], U)
    assert a.notes == ('column "y" is from b.csv, joined in time on straight lines between its samples',)


def test_a_gap_of_a_joined_file_is_not_filled(load: Load) -> None:
    t, other = np.arange(N) * 0.01, np.delete(np.arange(0.0, 0.3, 0.005), range(20, 40))
    files = {"a": {"t": t, "u": U}, "b": {"t": other, "y": 3 * other}}
    (a,) = load('time = "t"', TWO, 'file = ["a.csv", "b.csv"]\njoin = "time"', **files).recordings
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(a.signals["y"][:30])), np.arange(10, 20))
    assert a.notes[0].endswith("between its samples, and missing across its gaps")


@pytest.mark.parametrize(
    ("names", "units", "message"),
    [
        ("t,y", "s,V", r'b\.csv has column "y" in "V", the card says "mV"'),
        ("t,y", "ms,", r'b\.csv has column "t" in "ms", the card says "s"'),
        ("Zeit,y", ",", r'b\.csv: no column "t".*have their time stamps in a column of one name'),
    ],
)
def test_names_and_units_of_a_joined_file(load: Load, names: str, units: str, message: str) -> None:
    with pytest.raises(UserError, match=message):
        load(
            'time = "t"',
            'u = { column = "u", unit = "V" }\ny = { column = "y", unit = "mV" }',
            'file = ["a.csv", "b.csv"]\njoin = "time"',
            a={"t": np.arange(N) * 0.01, "u": U},
            b="\n".join([names, units, *(f"{0.01 * k:.2f},1.5" for k in range(N))]) + "\n",
        )


def test_uneven_time_stamps_are_told_and_resampled_where_asked(load: Load) -> None:
    t = np.arange(N) * 0.01 + 0.002 * (np.arange(N) % 2)
    files = {"a": {"t": t, "u": 2 * t, "y": Y}}
    (as_it_is,) = load('time = "t"', TWO, **files).recordings
    np.testing.assert_array_equal(as_it_is.time, t)
    assert as_it_is.notes == (
        "time stamps are uneven: steps between 0.008 and 0.012 s, median 0.012 s; resample = 0.01 at the top of the card makes them even",
    )
    (even,) = load('time = "t"\nresample = 0.01', TWO, **files).recordings
    np.testing.assert_allclose(np.diff(even.time), 0.01)
    np.testing.assert_allclose(even.signals["u"], 2 * even.time, atol=1e-12)
    assert even.notes[1] == "resampled to steps of 0.01 s, on straight lines between samples"


def test_a_gap_is_told_where_it_would_be_filled(load: Load) -> None:
    t = np.delete(np.arange(N + 20) * 0.01, range(15, 35))
    files = {"a": {"t": t, "u": 2 * t, "y": Y}}
    (filled,) = load('time = "t"\nresample = 0.01', TWO, **files).recordings
    assert filled.notes[0] == (
        "gap in the time stamps: no sample for 0.21 s, from 0.14 to 0.35 s after the start (after sample 14, the first is 0; "
        "usual step 0.01 s), "
        "filled with straight lines by resample"
    )
    (as_it_is,) = load('time = "t"', TWO, **files).recordings
    assert as_it_is.notes == ()  # the commands warn of it
    with pytest.raises(UserError, match=r"need even time stamps.*gap in the time stamps.*each with its rows"):
        load('time = "t"\ndecimate = 2', TWO, **files)


def test_derivative_and_decimation(load: Load) -> None:
    t = np.arange(400) * 1e-3
    channels = (
        'u = { column = "u", unit = "V" }\nw = { column = "q", unit = "rad/s", file_unit = "deg", derivative = 40.0 }'
    )
    (a,) = load("sample_time = 0.001\ndecimate = 10", channels, a={"u": np.ones(400), "q": 90 * t}).recordings
    assert (len(a), a.sample_time, a.rows) == (40, 0.01, (0, 40))
    np.testing.assert_allclose(a.signals["w"], np.pi / 2, rtol=1e-6)
    np.testing.assert_allclose(a.signals["u"], 1.0)
    assert a.notes == (
        "w is the rate of change of the recorded samples behind a low pass at 40 Hz",
        "one of 10 samples kept, behind a low pass against aliasing",
    )


ONE = 'file = "a.csv"'
TWICE = 'file = ["a.csv", "a.csv"]'
UNEVEN = {"t": np.array([0.0, 0.3, *range(1, 19)]), "u": np.ones(20), "y": np.ones(20)}
EVEN = {"t": np.arange(20.0), "u": np.ones(20), "y": np.ones(20)}


@pytest.mark.parametrize(
    ("top", "channels", "experiment", "a", "message"),
    [
        ('time = { column = "t", unit = "sec" }', TWO, ONE, EVEN, 'time, unit: found "sec", expected'),
        ('time = { colum = "t" }', TWO, ONE, EVEN, 'time: unknown key "colum" (did you mean "column"?)'),
        ("time = true", TWO, ONE, EVEN, "time: found true, expected the column of time stamps"),
        ("time = 0", TWO, ONE, EVEN, "0 is not a column; expected a name, or a position from 1 on"),
        ("sample_time = 1e308", TWO, ONE, EVEN, "sample_time: 1e+308 s makes times that are no numbers"),
        ("sample_time = 1\nresample = 1", TWO, ONE, EVEN, '"resample" is of time stamps'),
        ('time = "t"\nresample = 0', TWO, ONE, EVEN, "resample: 0 is not a sample time"),
        ('time = "t"\nresample = 1e-9', TWO, ONE, EVEN, "resample = 1e-09 s makes"),
        ("sample_time = 1\ndecimate = 1", TWO, ONE, EVEN, "decimate: found 1, expected at least 2"),
        ("sample_time = 1\ndecimate = 3", TWO, ONE, EVEN, "has 7 samples; expected at least 10"),
        ('time = "t"\ndecimate = 2', TWO, ONE, UNEVEN, "need even time stamps; expected resample = <seconds> as well"),
        ("sample_time = 1", 'u = { unit = "V" }', ONE, EVEN, '[channels], u: "column" is missing; expected column'),
        ("sample_time = 1", 'u = { column = "u", expr = "u" }', ONE, EVEN, 'both "column" and "expr" are given'),
        ("sample_time = 1", 'u = { expr = "u +" }', ONE, EVEN, '[channels], u, expr: "u +" is not an expression'),
        ("sample_time = 1", "u = { expr = \"__import__('os')\" }", ONE, EVEN, "is not understood; expected numbers, columns"),
        ("sample_time = 1", 'u = { expr = "u + v" }', ONE, EVEN, 'a.csv: no column "v"; found t, u, y'),
        ("sample_time = 1", 'u = { expr = "log(u - 1)" }', ONE, EVEN, "found -inf"),
        ("sample_time = 1", 'u = { expr = "sqrt(-u)" }', ONE, EVEN, '"sqrt(-u)" is no number at sample 0'),
        ("sample_time = 1", 'u = { column = "u", scale = 1e200 }', ONE, EVEN, "once scaled: found 1e+200"),
        ("sample_time = 1", 'u = { column = "u", scale = 2, unit = "V", file_unit = "mV" }', ONE, EVEN, 'both "scale" and "file_unit"'),
        ("sample_time = 1", 'u = { column = "u", file_unit = "mV" }', ONE, EVEN, '"file_unit" is given without "unit"'),
        ("sample_time = 1", 'u = { column = "u", unit = "V", file_unit = "rpm" }', ONE, EVEN, 'cannot be converted to "V"'),
        ("sample_time = 1", 'u = { column = "u", derivative = 0 }', ONE, EVEN, "derivative: 0 is not a cut-off"),
        ("sample_time = 1", 'u = { column = "u", derivative = 1 }', ONE, EVEN, "expected less than half the sampling rate, 0.5 Hz"),
        ("sample_time = 1", "u = { column = 0 }", ONE, EVEN, "0 is not a column"),
        ("sample_time = 1", "u = { column = 9 }", ONE, EVEN, "no column #9; found 3 columns"),
        ("sample_time = 1", "u = { column = 1.5 }", ONE, EVEN, "column: found 1.5, expected the name of a column"),
        ("sample_time = 1", TWO, "file = 3", EVEN, "file: found 3, expected the name of a file, or a list of names"),
        ("sample_time = 1", TWO, "file = []", EVEN, "file: found [], expected the name of a file"),
        ("sample_time = 1", TWO, TWICE, EVEN, 'several files are given without "join"'),
        ("sample_time = 1", TWO, TWICE + '\njoin = "time"', EVEN, 'join = "time" needs time stamps'),
        ('time = "t"', TWO, TWICE + '\njoin = "concatenate"', EVEN, "found 0 s after 19 s"),
        ('time = "t"', TWO + '\nz = { column = "z" }', TWICE + '\njoin = "time"', EVEN, 'no column "z"; it is in none of a.csv, a.csv'),
    ],
)  # fmt: skip
def test_what_can_be_wrong(
    load: Load, top: str, channels: str, experiment: str, a: dict[str, np.ndarray], message: str
) -> None:
    with pytest.raises(UserError) as error:
        load(top, channels, experiment, a=a)
    assert message in str(error.value)


def test_a_unit_in_the_file_that_is_not_the_cards(load: Load) -> None:
    text = "u;y\n[V];[deg/s]\n" + "1,5;2\n" * 20
    with pytest.raises(
        UserError,
        match=r'a.csv has column "y" in "deg/s", the card says "rad/s"; expected file_unit = "deg/s" .*0.0174',
    ):
        load("sample_time = 1", TWO, a=text)
    told = 'u = { column = "u", unit = "V" }\ny = { column = "y", unit = "rad/s", file_unit = "deg/s" }'
    np.testing.assert_allclose(load("sample_time = 1", told, a=text).recordings[0].signals["y"], 2 * np.pi / 180)
    scaled = told.replace('file_unit = "deg/s"', "scale = 1.0")
    assert load("sample_time = 1", scaled, a=text).recordings[0].signals["y"][0] == 2.0


def test_no_python_of_a_card_is_run(load: Load, tmp_path: Path) -> None:
    with pytest.raises(UserError):
        load("sample_time = 1", f"u = {{ expr = \"open('{tmp_path}/ran', 'w').write('x')\" }}", a=EVEN)
    assert not (tmp_path / "ran").exists()
