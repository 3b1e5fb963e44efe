"""Columns of one experiment in units of its own: of time stamps, and of channels by `file_unit` or `scale`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greybox_torch.checking.as_in_the_file import as_in_the_file
from greybox_torch.checking.joined_files import joined_files
from greybox_torch.checking.shared_columns import shared_columns
from greybox_torch.checking.time_stamps import odd_time_stamps
from greybox_torch.data import load_dataset
from greybox_torch.drafting.contradicted import contradictions
from greybox_torch.errors import UserError

CARD = """time = {{ column = "t", unit = "ms" }}
[channels]
h = {{ column = "h", unit = "m", file_unit = "cm" }}
n = {{ column = "n" }}
[[experiment]]
name = "a"
file = "a.csv"
[[experiment]]
name = "b"
file = "b.csv"
columns = {columns}
"""
OWN = '{ time = { column = "time_s", unit = "s" }, h = { column = "h", scale = -1.0 }, n = "k" }'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    lines = [f"{20 * k},{100 * k},{k}" for k in range(40)]
    (tmp_path / "a.csv").write_text("\n".join(["t,h,n", *lines]))
    lines = [f"{0.02 * k:.2f},{-k},{k},{k}" for k in range(40)]
    (tmp_path / "b.csv").write_text("\n".join(["time_s,h,k,n", *lines]))
    return tmp_path


def card(folder: Path, columns: str = OWN) -> Path:
    (folder / "dataset.toml").write_text(CARD.format(columns=columns))
    return folder / "dataset.toml"


def test_units_of_one_experiment(folder: Path) -> None:
    """Seen: "this one needs a card of its own", with which no fit has both."""
    data = load_dataset(card(folder))
    a, _, b, _ = data.recordings
    np.testing.assert_allclose(a.time, b.time, atol=1e-12)
    np.testing.assert_allclose(a.signals["h"], b.signals["h"])
    assert list(odd_time_stamps(data, joined_files(data))) == [] and contradictions(data.path) == []


@pytest.mark.parametrize("join", ["concatenate", "time"])
def test_a_unit_of_time_of_its_own_where_files_are_joined(folder: Path, join: str) -> None:
    names, *rows = (folder / "b.csv").read_text().splitlines()
    if join == "concatenate":
        parts = ([names, *rows[:20]], [names, *rows[20:]])
    else:
        cells = [row.split(",") for row in (names, *rows)]
        parts = ([",".join(row[:2]) for row in cells], [f"{row[0]},{row[2]}" for row in cells])
    for file, lines in zip(("b.csv", "c.csv"), parts, strict=True):
        (folder / file).write_text("\n".join(lines))
    path = card(folder)
    path.write_text(path.read_text().replace('"b.csv"', f'["b.csv", "c.csv"]\njoin = "{join}"'))
    data = load_dataset(path)
    a, _, b, _ = data.recordings
    np.testing.assert_allclose(a.time, b.time, atol=1e-12)
    np.testing.assert_allclose(a.signals["n"], b.signals["n"], atol=1e-9)
    assert list(odd_time_stamps(data, joined_files(data))) == [] and len(list(joined_files(data))) == 2 * (
        join == "time"
    )


def test_samples_as_the_file_has_them(folder: Path) -> None:
    data = load_dataset(card(folder))
    where, values = as_in_the_file(data, data.recordings[2], "h", 3)
    assert where == f'{folder / "b.csv"}, line 5, column "h", sample 3 (the first is 0)'
    assert values is not None and values[:3].tolist() == [0.0, -1.0, -2.0]


def test_a_column_that_is_shared_in_another_unit(folder: Path) -> None:
    own = '{ time = { column = "time_s", unit = "s" }, h = { column = "k", file_unit = "mm" }, n = "k" }'
    (one,) = shared_columns(load_dataset(card(folder, own)))
    assert str(one).startswith('[[experiment]] "b", columns: "h" [m] and "n" are both read from "k"')


def test_a_conversion_of_its_own_takes_the_place_of_the_channels(folder: Path) -> None:
    own = '{ time = { column = 1, unit = "s" }, h = { column = 2, file_unit = "mm" } }'
    assert load_dataset(card(folder, own)).recordings[2].signals["h"][10] == pytest.approx(-0.01)
    own = '{ time = { column = 1, unit = "s" }, h = 2 }'
    assert load_dataset(card(folder, own)).recordings[2].signals["h"][10] == pytest.approx(-0.1)


@pytest.mark.parametrize(
    ("units", "write"),
    [
        (("s", "s"), 'columns = { time = { column = "t", unit = "ms" } } in [[experiment]] "a"'),
        (("ms", "ms"), 'columns = { time = { column = "time_s", unit = "s" } } in [[experiment]] "b"'),
        (("us", "us"), 'columns = { time = { column = "time_s", unit = "ms" } } in [[experiment]] "b"'),
        (("s", "h"), ""),
    ],
)
def test_the_experiment_in_the_wrong_unit_of_time_is_named(folder: Path, units: tuple[str, str], write: str) -> None:
    """Seen: the advice was for the experiment that was right, and to write what it had."""
    path = card(folder, f'{{ time = {{ column = "time_s", unit = "{units[1]}" }}, n = "k" }}')
    path.write_text(
        path.read_text().replace('{ column = "t", unit = "ms" }', f'{{ column = "t", unit = "{units[0]}" }}')
    )
    odd = list(odd_time_stamps(load_dataset(path), {}))
    assert [one.write for one in odd] == ([write] if write else [])


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        (
            '{ time = { column = "time_s", file_unit = "s" } }',
            'columns, time: found "file_unit", expected { column = "t", unit = "ms" } of time stamps',
        ),
        (
            '{ time = { column = "t", unit = "days" } }',
            'columns, time: found unit = "days", expected s ms us µs ns min h',
        ),
        (
            '{ h = { column = "h", unit = "m" } }',
            'columns, h: found "unit", expected { column = "…", file_unit = "…" }',
        ),
        ('{ h = { column = "h", expr = "2 * h" } }', 'both "column" and "expr" are given; expected one of them'),
        ("{ h = { scale = 1.0 } }", 'neither "column" nor "expr" is given; expected one of them'),
        ('{ time = { expr = "2 * t" } }', 'columns, time: found "expr", expected { column = "t", unit = "ms" } of'),
        ('{ h = { column = "h", file_unit = "m", scale = 1.0 } }', 'both "scale" and "file_unit" are given'),
        ('{ n = { column = "k", file_unit = "m" } }', 'columns, n: "file_unit" is given, and "n" has no unit'),
        ('{ n = { colum = "k" } }', 'unknown key "colum" (did you mean "column"?)'),
        ("{ n = 1.5 }", "expected the name of a column, or its position from 1 on"),
    ],
)
def test_what_is_wrong_is_told_with_the_field(folder: Path, columns: str, message: str) -> None:
    with pytest.raises(UserError) as refused:
        load_dataset(card(folder, columns))
    assert message in str(refused.value)
