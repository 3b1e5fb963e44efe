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
        ("u,y\n1,2\n[V],[rad]\n", 'a.csv, line 3, column "u": found "[V]", expected a number'),
        ("u,y\n1_000,2\n", 'a.csv, line 2, column "u": found "1_000", expected a number'),
        ("u,y\n\u0661\u0662,2\n", 'line 2, column "u": found "\u0661\u0662", expected a number'),
        ("u,y\n\uff11,2\n", 'column "u": found "\uff11", expected a number'),
        ("u,y\n0x10,2\n", 'found "0x10"'),
        (
            "u;y\n1,5;2.5\n3,5;2\n",
            'line 2, column "y": found "2.5", expected a number (missing samples are empty cells, NaN, or marks such as --- and N/A; dec',
        ),
        ("u;y\n1.234,5;2\n3,5;2\n", 'line 2, column "u": found "1.234,5"'),
        (
            'u,y\n1,2\n3,"4\n5,6\n7,8\n',
            "a.csv, line 3: not comma-separated values: a quotation mark is opened here and not closed",
        ),
        ("a,b\nc,d\n", 'no column "u"; found a, b'),
        ("#2\n", 'no column "u"; found #2'),
        ("u,y\n1,2,3,4\n", "a.csv, line 2: found 4 cell(s), expected 2"),
        ("u,y\n1,2\n3\n", "a.csv, line 3: found 1 cell(s), expected 2"),
        ("u,u,y\n1,2,3\n", 'a.csv, line 1: 2 columns are named "u"; expected one'),
        ("U;Y\n1;2\n", 'no column "u" (did you mean "U"?); found U, Y'),
        ("", "a.csv: has nothing but blank lines; expected a line of column names, and lines of samples"),
        (" \n\n", "a.csv: has nothing but blank lines"),
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


@pytest.mark.parametrize(
    ("text", "encoding"),
    [
        ("u;y\n1,5;-2\n3;4e-1\n", "utf-8"),
        ("u\ty\n1.5\t-2\n3\t4e-1\n", "utf-8"),
        ("u\ty\n1,5\t-2\n3\t4e-1\n", "utf-8"),
        ("u|y\n1.5|-2\n3|0.4\n", "utf-8"),
        ("  u   y\n  1.5  -2\n  3.0 0.4\n", "utf-8"),
        ("u,y\nV,rad/s\n1.5,-2\n3,0.4\n", "utf-8"),
        ("t;u;y\n[s];[V];[°/s]\n0;1,5;-2\n1;3;0,4\n", "cp1252"),
        ("u;y;µ\n1,5;-2;0\n3;0,4;0\n", "utf-16"),
        ("Bench 3; Müller\n\nDate: 21.11.2026\nRate: 1000 Hz\nt,u,y\n0,1.5,-2\n1,3,0.4\n", "cp1252"),
        ('# "quoted once\n#\nu,y\n1.5,-2\n3,0.4\n', "utf-8"),
        ('"u" , "y"\n"1.5" , "-2"\n3,0.4\n', "utf-8"),
        ('note,u,y\n"a\nb",1.5,-2\n,3,.4\n', "utf-8"),
    ],
)
def test_what_instruments_write(tmp_path: Path, text: str, encoding: str) -> None:
    (tmp_path / "a.csv").write_bytes(text.encode(encoding))
    columns = read_csv(tmp_path / "a.csv", ("u", "y")).columns
    assert (columns["u"].tolist(), columns["y"].tolist()) == ([1.5, 3.0], [-2.0, 0.4])


@pytest.mark.parametrize(
    "text",
    [
        "0,1.5,-2\n1,3,0.4\n",
        "0;1,5;-2\n1;3;0,4\n",
        "0 1.5 -2\n1  3  0.4\n",
        "t,u,y\n0,1.5,-2\n1,3,0.4\n",
        "made by hand\n0\t1.5\t-2\n1\t3\t0.4\n",
    ],
)
def test_columns_by_their_position(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.csv").write_text(text)
    columns = read_csv(tmp_path / "a.csv", ("#2", "#3")).columns
    assert (columns["#2"].tolist(), columns["#3"].tolist()) == ([1.5, 3.0], [-2.0, 0.4])


def test_lines_count_from_the_beginning_of_the_file(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("made\nby hand\nu;y\n[V];[rad]\n1;2\n3;x\n")
    table = read_csv(tmp_path / "a.csv", ("u",))
    assert list(table.lines or ()) == [5, 6]
    assert table.units == {"u": "V"}
    with pytest.raises(UserError, match=r'line 6, column "y": found "x"'):
        read_csv(tmp_path / "a.csv", ("y",))


@pytest.mark.parametrize("heading", ["t,u,y", "date,u,y"])
def test_a_heading_among_the_samples_says_what_to_do(tmp_path: Path, heading: str) -> None:
    """Seen: a logger that was started anew; the message named a cell, and not what it was nor what to write."""
    first = heading.split(",")[0]
    times = ["0", "1"] if first == "t" else ["2026-03-02T08:15:00", "2026-03-02T08:15:02"]
    (tmp_path / "a.csv").write_text(f"{heading}\n{times[0]},1,2\n{heading}\n{times[1]},3,4\n")
    with pytest.raises(UserError, match=r"line 3: found the names of the columns again.*; expected the file divided"):
        read_csv(tmp_path / "a.csv", (first, "u", "y"))


@pytest.mark.parametrize(
    ("mark", "unit"), [("-", "1"), ("1", "1"), ("--", "1"), ("---", "1"), ("none", ""), ("n/a", ""), ("[-]", "1")]
)
def test_a_column_without_a_unit_in_a_line_of_units(tmp_path: Path, mark: str, unit: str) -> None:
    """Seen: the column was lost for "-", and with "1" another one "found "V", expected a number"."""
    (tmp_path / "a.csv").write_text(f"t;duty;battery\nus;{mark};V\n0;0.5;15.1\n5000;0.6;15.2\n")
    for asked in (("duty",), ("duty", "battery"), ("t", "duty", "battery")):
        table = read_csv(tmp_path / "a.csv", asked)
        assert table.columns["duty"].tolist() == [0.5, 0.6]
        assert table.units.get("duty", "") == unit


@pytest.mark.parametrize("row", ["0;-;5", "1;-;1", "1;-;RUN"])
def test_samples_are_no_line_of_units(tmp_path: Path, row: str) -> None:
    (tmp_path / "a.csv").write_text(f"t;duty;state\n{row}\n2;3;STOP\n")
    table = read_csv(tmp_path / "a.csv", ("duty",))
    np.testing.assert_array_equal(table.columns["duty"], [np.nan, 3.0])
    assert not table.units
