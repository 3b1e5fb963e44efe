"""What people and spreadsheets do to CSV files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greybox_torch.data.readers.csv import read_csv
from greybox_torch.errors import UserError

NAN = float("nan")


@pytest.mark.parametrize(
    ("text", "u", "y"),
    [
        ("u,y\n1,2\n3,4\n", [1, 3], [2, 4]),
        ("u,y\r\n1,2\r\n3,4\r\n", [1, 3], [2, 4]),
        ("\ufeffu,y\n1,2\n3,4", [1, 3], [2, 4]),
        ('"u","y"\n"1","2"\n3,4\n', [1, 3], [2, 4]),
        (" u , y \n 1 , 2 \n 3,4\n", [1, 3], [2, 4]),
        ("y,note,u\n2,text,1\n4,more,3\n", [1, 3], [2, 4]),
        ("u,y\n1,2,\n3,4,\n", [1, 3], [2, 4]),
        ("u,y\n1,NaN\nnan,\n , NAN \n", [1, NAN, NAN], [NAN, NAN, NAN]),
        ("u,y\n1,2\n\n3,4\n\n\n", [1, NAN, 3], [2, NAN, 4]),
        ("u,y\n1,2\n,\n", [1, NAN], [2, NAN]),
        ("u,y\n1e-3,-2E+5\n", [0.001], [-2e5]),
        ("u,y\n", [], []),
    ],
)
def test_reads(tmp_path: Path, text: str, u: list[float], y: list[float]) -> None:
    path = tmp_path / "a.csv"
    path.write_bytes(text.encode())
    columns = read_csv(path, ("u", "y")).columns
    np.testing.assert_array_equal(columns["u"], u)
    np.testing.assert_array_equal(columns["y"], y)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("u,y\n1,2\n\n3,abc\n", 'a.csv, line 4, column "y": found "abc", expected a number'),
        ("u,y\n[V],[rad]\n1,2\n", 'a.csv, line 2, column "u": found "[V]", expected a number'),
        ("u,y\n1,2\n3,NA\n", 'line 3, column "y": found "NA"'),
        ("u,y\n1,2,3,4\n", "a.csv, line 2: found 4 cell(s), expected 2"),
        ("u,y\n1,2\n3\n", "a.csv, line 3: found 1 cell(s), expected 2"),
        ("u,u,y\n1,2,3\n", 'a.csv, line 1: 2 columns are named "u"; expected one'),
        ("u;y\n1;2\n", 'no column "u"; found u;y'),
        ("", 'no column "u"; found none'),
        ('u,y\n"' + "1" * 140000 + '",2\n', "a.csv, line 2: not comma-separated values"),
    ],
)
def test_refuses_with_the_line(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(text)
    with pytest.raises(UserError) as error:
        read_csv(path, ("u", "y"))
    assert message in str(error.value)


def test_lines_of_samples_count_what_stands_between(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text('note,u\n"two\nlines",1\n\nx,2\n')
    table = read_csv(path, ("u",))
    assert table.lines is not None
    assert list(table.lines) == [3, 4, 5]
    assert table.place("u", 2) == f'{path}, line 5, column "u", sample 2 (the first is 0)'
