"""Rows of plain numbers are read at once, and just as the careful reading reads them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greybox_torch.data.readers import csv
from greybox_torch.data.readers.csv import read_csv
from greybox_torch.data.readers.table import Table
from greybox_torch.errors import UserError


@pytest.fixture
def carefully(monkeypatch):
    """Reads row by row."""

    def read(path: Path, columns: list[str]) -> Table:
        with monkeypatch.context() as patched:
            patched.setattr(csv, "clean_rows", lambda file, layout: None)
            return read_csv(path, columns)

    return read


def numbers(separator: str, end: str = "\n", decimal: str = ".") -> str:
    rng = np.random.default_rng(3)
    rows = [
        ["t", "u", "y"],
        *([repr(float(v)) for v in row] for row in rng.normal(size=(50, 3)) * 10.0 ** rng.integers(-9, 9)),
    ]
    return "".join(separator.join(row).replace(".", decimal) + end for row in rows)


PLAIN = {
    "commas": numbers(","),
    "Windows": numbers(",", "\r\n"),
    "spaces after commas": numbers(", "),
    "tabs": numbers("\t"),
    "spaces": numbers("  "),
    "semicolons": numbers(";"),
    "decimal commas": numbers(";", decimal=","),
    "no line end": numbers(",").rstrip("\n"),
    "units": "t,u,y\ns,V,rad\n1,2,3\n4,5e-3,-6\n",
}


@pytest.mark.parametrize("text", PLAIN.values(), ids=PLAIN)
def test_plain_numbers(text: str, tmp_path: Path, monkeypatch, carefully) -> None:
    file = tmp_path / "run.csv"
    file.write_bytes(text.encode())
    expected = carefully(file, ["y", "t"])
    monkeypatch.setattr(csv, "_read_samples", None)  # cannot be called
    found = read_csv(file, ["y", "t"])
    assert found.columns.keys() == expected.columns.keys()
    for name, samples in expected.columns.items():
        np.testing.assert_array_equal(found.columns[name], samples)
    assert (list(found.lines or ()), found.units) == (list(expected.lines or ()), expected.units)


@pytest.mark.parametrize(
    ("text", "samples"),
    [
        ("t,y\n1,2\n3,\n5,6\n", [2.0, np.nan, 6.0]),
        ("t,y\n1,2\n\n5,6\n", [2.0, np.nan, 6.0]),
        ("t,y\n1,2\n3,nan\n", [2.0, np.nan]),
        ('t,y\n1,"2"\n3,4\n', [2.0, 4.0]),
        ("t,y\n1,2\n3,4\n\n\n", [2.0, 4.0]),
        ("t,y\n1,2,\n3,4\n", [2.0, 4.0]),
    ],
    ids=["empty cell", "blank line", "NaN", "quoted", "blank end", "cell more"],
)
def test_what_is_not_plain_is_read_carefully(text: str, samples: list[float], tmp_path: Path) -> None:
    file = tmp_path / "run.csv"
    file.write_text(text)
    np.testing.assert_array_equal(read_csv(file, ["y"]).columns["y"], samples)


@pytest.mark.parametrize(
    ("last", "message"),
    [("3,4-5", r'line 3, column "y": found "4-5"'), ("3,1_000", r'found "1_000"'), ("3", r"line 3: found 1 cell")],
)
def test_faults_have_their_line(last: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "run.csv"
    file.write_text(f"t,y\n1,2\n{last}\n")
    with pytest.raises(UserError, match=message):
        read_csv(file, ["y"])
