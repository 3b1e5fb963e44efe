"""Marks of missing samples, as loggers and spreadsheets write them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.data.columns import columns_of
from greybox_torch.data.readers import read_table
from greybox_torch.data.readers.missing_marks import is_missing
from greybox_torch.errors import UserError

USUAL = [
    "---", "-", "–", "N/A", "NA", "n.a.", "#N/A", "#NA", "#NV", "null", "NULL", "None", "nan", "NaN", "?", "1.#QNAN", "-1.#IND", "1,#QNAN",
    "-nan(ind)", "missing", "k.A.",
]  # fmt: skip
ELSE = ["OVER", "Bad", "1.#INF", "inf-", "x", "1-", "0", "natural", "#REF!"]


@pytest.mark.parametrize("mark", USUAL)
@pytest.mark.parametrize("at", [0, 3])
def test_the_usual_ones_are_missing_samples(tmp_path: Path, mark: str, at: int) -> None:
    """Seen: all of them but "nan" were refused."""
    cells = [mark if k == at else f"{k},5" for k in range(6)]
    text = "t;u\n" + "".join(f"{k};{cell}\n" for k, cell in enumerate(cells))
    (tmp_path / "a.csv").write_text(text, encoding="utf-8")
    assert columns_of(tmp_path / "a.csv").names == ("t", "u")
    table = read_table(tmp_path / "a.csv", ("t", "u"))
    assert np.flatnonzero(np.isnan(table.columns["u"])).tolist() == [at]
    assert table.columns["u"][5] == 5.5 and not table.units
    if mark.lower() != "nan":
        assert table.notes == (f'column "u" of a.csv: "{mark}" is read as a missing sample, 1 time',)


@pytest.mark.parametrize("cell", ELSE)
def test_nothing_else_is(cell: str) -> None:
    assert not is_missing(cell)


def test_files_without_names_and_json(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("0 --- 1\n1 2 3\n2 N/A 5\n")
    np.testing.assert_array_equal(read_table(tmp_path / "a.csv", ("#2",)).columns["#2"], [np.nan, 2.0, np.nan])
    (tmp_path / "a.json").write_text(json.dumps({"t": [0, 1], "u": ["N/A", 1.0]}))
    assert columns_of(tmp_path / "a.json").names == ("t", "u")
    np.testing.assert_array_equal(read_table(tmp_path / "a.json", ("u",)).columns["u"], [np.nan, 1.0])


def test_others_are_told_with_what_to_write_and_can_be_declared(tmp_path: Path) -> None:
    rows = [f"{0.1 * k:.1f},{k},{'OVER' if k in (0, 7) else 'Bad' if k == 9 else k}" for k in range(40)]
    (tmp_path / "a.csv").write_text("\n".join(["t,u,y", *rows]))
    card = (
        'time = "t"\n[channels]\nu = { column = "u" }\ny = { column = "y"MISSING }\n[[experiment]]\nname = "A"\nfile = "a.csv"\n'
        'role = "validation"\n'
    )
    (tmp_path / "dataset.toml").write_text(card.replace("MISSING", ""))
    with pytest.raises(UserError, match=r'line 2, column "y": found "OVER".*missing = "OVER" in the channel') as error:
        gt.load_dataset(tmp_path / "dataset.toml")
    assert "\n" not in str(error.value)
    (tmp_path / "dataset.toml").write_text(card.replace("MISSING", ', missing = ["OVER", "Bad", 11]'))
    found = gt.load_dataset(tmp_path / "dataset.toml").recordings[0].signals["y"]
    assert np.flatnonzero(np.isnan(found)).tolist() == [0, 7, 9, 11]
    (tmp_path / "dataset.toml").write_text(card.replace("MISSING", ', missing = "OVER"'))
    with pytest.raises(UserError, match='line 11, column "y": found "Bad"'):
        gt.load_dataset(tmp_path / "dataset.toml")
