"""Dates that may be read in two ways: decided for all files of an experiment together, refused where the year comes first or no date is."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.data import load_dataset
from greybox_torch.data.readers import read_table
from greybox_torch.data.readers.time_stamps import TimeStamps, _days_in, is_time_stamp
from greybox_torch.errors import UserError

CARD = """time = "t"
[channels]
u = { column = "u" }
[[experiment]]
name = "days"
file = ["a.csv", "b.csv"]
join = "concatenate"
"""


def card(folder: Path, first: str, second: str) -> Path:
    """Of two files, the first from 23:00 to midnight of a date, the second on from there."""
    for name, date, hour in (("a", first, 23), ("b", second, 0)):
        rows = [f"{date} {hour:02}:{k:02}:00,{k}" for k in range(60)]
        (folder / f"{name}.csv").write_text("\n".join(["t,u", *rows]) + "\n")
    (folder / "dataset.toml").write_text(CARD)
    return folder / "dataset.toml"


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("12/03/2026", "13/03/2026"),  # the second file tells
        ("03/31/2026", "04/01/2026"),  # the first one does
        ("03/04/2026", "04/04/2026"),  # they follow each other so
    ],
)
def test_one_order_for_all_files_of_an_experiment(tmp_path: Path, first: str, second: str) -> None:
    """Seen: the first file counted from midnight, the second from 1970, "a gap of 1.773e9 s"."""
    data = load_dataset(card(tmp_path, first, second))
    time = np.concatenate([recording.time for recording in data.recordings])
    assert np.diff(time) == pytest.approx(np.full(len(time) - 1, 60.0))
    assert any("are read with the" in note for recording in data.recordings for note in recording.notes)


def test_dates_in_a_column_of_their_own(tmp_path: Path) -> None:
    path = card(tmp_path, "12/03/2026", "13/03/2026")
    for name in "ab":
        file = tmp_path / f"{name}.csv"
        file.write_text(file.read_text().replace("t,u", "d,t,u").replace("2026 ", "2026,"))
    path.write_text(CARD.replace('"t"', '{ column = "t", date = "d" }'))
    time = np.concatenate([recording.time for recording in load_dataset(path).recordings])
    assert np.ptp(time) == pytest.approx(119 * 60.0)


@pytest.mark.parametrize("ending", ["csv", "json", "memory"])
def test_what_was_concluded_is_told(tmp_path: Path, ending: str) -> None:
    """Seen: of a file in JSON and of data in memory, and on the card, not a word."""
    stamps = [f"{day:02}/04/2026 {hour:02}:00" for day in (3, 4) for hour in range(24)]
    note = 'dates such as "03/04/2026" are read with the day before month, as they follow each other so'
    if ending == "memory":
        run = gt.Recording.from_arrays("run", {"u": np.arange(48.0)}, time=stamps)
        assert run.notes == (f"time: {note}",)
        return
    file, rows = tmp_path / f"run.{ending}", list(zip(stamps, range(48), strict=True))
    as_text = {
        "csv": "\n".join(["t,u", *(f"{t},{u}" for t, u in rows)]),
        "json": json.dumps([{"t": t, "u": u} for t, u in rows]),
    }
    file.write_text(as_text[ending])
    text = gt.card(file).text
    (line,) = (line for line in text.splitlines() if line.startswith('time = "t"'))
    assert line.endswith(f"; {note}")
    (tmp_path / "dataset.toml").write_text(CARD.split("file")[0] + f'file = "run.{ending}"\n')
    assert f'column "t" of run.{ending}: {note}' in load_dataset(tmp_path / "dataset.toml").recordings[0].notes


def test_a_date_in_json_that_is_none(tmp_path: Path) -> None:
    (tmp_path / "run.json").write_text(json.dumps([{"t": t, "u": 1} for t in ("12/31/2026", "12/32/2026")]))
    with pytest.raises(UserError, match=r'"t", sample 1 \(the first is 0\): found "12/32/2026": no such date'):
        read_table(tmp_path / "run.json", ["t"])


@pytest.mark.parametrize("second", ["08/09/2026", "2026-05-04"])
def test_an_order_that_no_file_tells_is_refused(tmp_path: Path, second: str) -> None:
    with pytest.raises(UserError) as refused:
        load_dataset(card(tmp_path, "03/04/2026", second))
    assert 'a.csv, column "t": found "03/04/2026", and other dates in other files' in str(refused.value)


def test_files_of_one_date_are_joined_as_they_are(tmp_path: Path) -> None:
    path = card(tmp_path, "03/04/2026", "03/04/2026")
    (tmp_path / "b.csv").write_text((tmp_path / "a.csv").read_text().replace("t,u", "t,v"))
    path.write_text(CARD.replace("concatenate", "time").replace("[[exp", 'v = { column = "v" }\n[[exp'))
    assert all(recording.time[0] >= 82800.0 for recording in load_dataset(path).recordings)


@pytest.mark.parametrize("dates", [("26/03/30", "26/03/31", "26/04/01"), ("26.03.30", "26.03.31")])
def test_a_year_of_two_digits_that_comes_first(dates: tuple[str, ...]) -> None:
    """Seen: the days of a month were years, 2030, 2031 and 2001."""
    stamps = TimeStamps(f"{date} 12:00" for date in dates)
    with pytest.raises(ValueError, match="where the year comes first; expected a date like 2026-03-30"):
        stamps.seconds(f"{dates[0]} 12:00")


def test_of_very_many_samples_only_their_dates_are_kept() -> None:
    days = _days_in(f"{day:02}/04/2026 12:00:{k % 60:02}" for day in (3, 4) for k in range(1000))
    assert [(day.date, day.first[-2:], day.last[-2:]) for day in days] == [
        ("03/04/2026", "00", "39"),
        ("04/04/2026", "00", "39"),
    ]


def test_a_year_of_two_digits_that_comes_last() -> None:
    """Over the turn of a year, and of the first days of months."""
    for dates in (("30/12/25", "31/12/25", "01/01/26"), ("01/11/25", "01/12/25", "01/01/26")):
        TimeStamps(dates).seconds(dates[-1])


@pytest.mark.parametrize(
    ("dates", "wrong"), [(("45/67/2026",), 0), (("04/13/2026", "04/31/2026"), 1), (("03/04/2026", "45/67/2026"), 1)]
)
def test_there_is_no_such_date(dates: tuple[str, ...], wrong: int) -> None:
    stamps = TimeStamps(dates)
    for k, date in enumerate(dates):
        if k < wrong:
            stamps.seconds(date)
        else:
            with pytest.raises(ValueError, match="no such date"):
                stamps.seconds(date)
    assert not is_time_stamp("45/67/2026") and is_time_stamp("12/31/2026")
