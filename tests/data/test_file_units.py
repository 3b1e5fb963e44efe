"""Units that the file says and the card contradicts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.data.time_units import unit_of_time
from greybox_torch.data.understood_units import other_quantity, understood
from greybox_torch.errors import UserError


def loaded(
    folder: Path, unit: str, channel: str, *, time: str = '"t"', time_unit: str = "s", other: str = ""
) -> gt.DataSet:
    rows = [f"{0.01 * k:.2f}\t{k}\t{k}" for k in range(40)]
    (folder / "a.txt").write_text("\n".join(["t\tq\tr", f"{time_unit}\t{unit}\tmm", *rows]))
    (folder / "dataset.toml").write_text(
        f'time = {time}\n[channels]\nq = {{ column = "q", {channel} }}\nr = {{ column = "r"{other} }}\n'
        '[[experiment]]\nname = "A"\nfile = "a.txt"\nrole = "validation"\n'
    )
    return gt.load_dataset(folder / "dataset.toml")


@pytest.mark.parametrize(
    ("unit", "channel", "message"),
    [
        (
            "bar", 'unit = "m", file_unit = "mm"',
            'a.txt has column "q" in "bar", the card says file_unit = "mm"; expected another column; or, if the file\'s unit is wrong, '
            "scale = 0.001 in the place of file_unit",
        ),
        ("Bar", 'unit = "m", file_unit = "mm"', '"q" in "Bar", the card says file_unit = "mm"; expected another column'),
        ("mm", 'unit = "m", file_unit = "cm"', 'file_unit = "cm"; expected file_unit = "mm"; or, if the file\'s unit is wrong, scale ='),
        ("mm", 'unit = "mm", file_unit = "m"', 'file_unit = "m"; expected no file_unit; or'),
        ("K", 'unit = "degC", file_unit = "degF"', 'expected file_unit = "K"; or, if the file\'s unit is wrong, expr = "0.555555556*q - 1'),
        ("degF", 'unit = "degC", file_unit = "K"', 'expected file_unit = "degF"; or, if the file\'s unit is wrong, expr = "q - 273.15" in'),
        ("deg", 'unit = "rad/s", file_unit = "rad", derivative = 10.0', 'file_unit = "rad"; expected file_unit = "deg"'),
        ("counts", 'unit = "rad", file_unit = "deg"', 'has "q" in "counts", the card says "rad"; how many counts has a turn?'),
        ("bar", 'unit = "m"', 'in "bar", the card says "m"; expected another column; or, if the file\'s unit is wrong, scale = 1.0'),
        ("Bar", 'unit = "Pa"', 'in "Bar", the card says "Pa"; expected file_unit = "bar" to convert it (100000)'),
        ("bar(g)", 'unit = "Pa"', 'in "bar(g)", the card says "Pa"; expected file_unit = "bar"'),
        ("deg", 'unit = "rad/s", derivative = 10.0', 'the card says "rad/s"; expected file_unit = "deg" to convert it (0.0174533)'),
    ],
)  # fmt: skip
def test_another_unit_than_the_files_is_refused(tmp_path: Path, unit: str, channel: str, message: str) -> None:
    """Seen: a pressure in bar passed for a position in mm."""
    with pytest.raises(UserError) as error:
        loaded(tmp_path, unit, channel)
    assert '[[experiment]] "A", channel "q": ' in str(error.value) and message in str(error.value)


@pytest.mark.parametrize(
    ("unit", "channel", "factor"),
    [
        ("mm", 'unit = "m", file_unit = "mm"', 1e-3),
        ("bar", 'unit = "m", scale = 0.001', 1e-3),
        ("MM", 'unit = "m", file_unit = "mm"', 1e-3),
        ("bar(a)", 'unit = "Pa", file_unit = "bar"', 1e5),
        ("-", 'unit = "m", file_unit = "mm"', 1e-3),
        ("1/s", 'unit = "rad/s", file_unit = "rev/s"', 2 * np.pi),
        ("U/min", 'unit = "rad/s", file_unit = "rpm"', np.pi / 30),
        ("g", 'unit = "m/s^2", file_unit = "g0"', 9.80665),
        ("C", 'unit = "degC"', 1.0),
        ("deg C", 'unit = "degC"', 1.0),
        ("T", 'unit = "N m"', 1.0),
        ("REAL", 'unit = "N m"', 1.0),
    ],
)
def test_what_does_not_contradict_is_read(tmp_path: Path, unit: str, channel: str, factor: float) -> None:
    read = loaded(tmp_path, unit, channel).recordings[0].signals["q"]
    np.testing.assert_allclose(read, factor * np.arange(40.0))


def test_what_to_write_of_an_experiments_own_column(tmp_path: Path) -> None:
    with pytest.raises(UserError):
        loaded(tmp_path, "deg", 'unit = "rad"')
    card = tmp_path / "dataset.toml"
    card.write_text(card.read_text() + '\ncolumns = { q = "q" }\n')
    with pytest.raises(UserError) as refused:
        gt.load_dataset(card)
    assert 'expected columns = { q = { column = "q", file_unit = "deg" } } in that [[experiment]]' in str(refused.value)


def test_what_to_write_if_the_file_is_wrong_is_read(tmp_path: Path) -> None:
    expr = 'expr = "0.555555556*q - 17.7777778", unit = "degC"'
    with pytest.raises(UserError, match="both"):
        loaded(tmp_path, "K", expr)
    card = (tmp_path / "dataset.toml").read_text().replace('column = "q", ', "")
    (tmp_path / "dataset.toml").write_text(card)
    read = gt.load_dataset(tmp_path / "dataset.toml").recordings[0].signals["q"]
    np.testing.assert_allclose(read, (np.arange(40.0) - 32) / 1.8, atol=1e-6)


def test_several_channels_are_told_at_once(tmp_path: Path) -> None:
    with pytest.raises(UserError) as error:
        loaded(tmp_path, "bar", 'unit = "m", file_unit = "mm"', other=', unit = "Pa", file_unit = "bar"')
    lines = str(error.value).splitlines()
    assert lines[0].endswith('[[experiment]] "A": 2 problems:')
    assert lines[1].startswith('  channel "q": ') and lines[2].startswith('  channel "r": ')


@pytest.mark.parametrize("said", ["msec", "millisec", "[ms]", "Milliseconds", "msecs"])
def test_a_unit_of_time_written_otherwise(tmp_path: Path, said: str) -> None:
    """Seen: a file in msec passed beside unit = "s", 8 s as 8000."""
    with pytest.raises(UserError, match=r'has column "t" in .*, the card says "s"; expected time = .*unit = "ms"'):
        loaded(tmp_path, "mm", 'unit = "mm"', time_unit=said)
    data = loaded(tmp_path, "mm", 'unit = "mm"', time_unit=said, time='{ column = "t", unit = "ms" }')
    assert data.recordings[0].sample_time == pytest.approx(1e-5)


@pytest.mark.parametrize(
    ("said", "unit"),
    [
        ("sec", "s"),
        ("Seconds", "s"),
        ("sec.", "s"),
        ("μs", "us"),
        ("µsec", "us"),
        ("minutes", "min"),
        ("hr", "h"),
        ("V", ""),
        ("", ""),
    ],
)
def test_units_of_time(said: str, unit: str) -> None:
    assert unit_of_time(said) == unit


def test_units_as_files_write_them() -> None:
    told = {unit: understood(unit) for unit in ("bar", "BAR", "barg", "bar (abs)", "KPA", "RPM", "Pond", "m(g)")}
    assert told == {
        "bar": "bar", "BAR": "bar", "barg": "bar", "bar (abs)": "bar", "KPA": "kPa", "RPM": "rpm", "Pond": "", "m(g)": "m(g)",
    }  # fmt: skip
    assert other_quantity("kg", "N") and not other_quantity("Hz", "rad/s") and not other_quantity("P", "bar")


def test_each_of_several_files_is_compared(tmp_path: Path) -> None:
    loaded(tmp_path, "mm", 'unit = "m", file_unit = "mm"')
    (tmp_path / "b.txt").write_text(
        (tmp_path / "a.txt").read_text().replace("\tmm\tmm", "\tm\tmm").replace("\n0.", "\n1.")
    )
    card = (tmp_path / "dataset.toml").read_text()
    joined = card.replace('file = "a.txt"', 'file = ["a.txt", "b.txt"]\njoin = "concatenate"')
    (tmp_path / "dataset.toml").write_text(joined)
    with pytest.raises(
        UserError, match=r'b.txt has column "q" in "m", the card says file_unit = "mm"; expected no file_unit'
    ):
        gt.load_dataset(tmp_path / "dataset.toml")
