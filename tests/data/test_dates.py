"""Dates in a column of their own beside times of day: added, wherever they are joined, and refused where they are none."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.checking.joined_files import joined_files
from greybox_torch.data import load_dataset
from greybox_torch.data.readers.time_stamps import TimeStamps, is_time_stamp
from greybox_torch.errors import UserError

CARD = """time = { column = "clock", date = "day" }
[channels]
u = { column = "u" }
y = { column = "y" }
[[experiment]]
name = "night"
file = ["u.csv", "y.csv"]
join = "time"
"""


@pytest.fixture
def card(tmp_path: Path) -> Path:
    """Two loggers over midnight, 0.1 and 0.2 s apart."""
    for name, step in (("u", 1), ("y", 2)):
        lines = ["day,clock," + name]
        for k in range(0, 200, step):
            tenths = (863_900 + k) % 864_000
            seconds, day = tenths / 10, 1 + (863_900 + k >= 864_000)
            clock = f"{int(seconds // 3600):02}:{int(seconds % 3600 // 60):02}:{seconds % 60:06.3f}"
            lines.append(f"2026-03-{day:02},{clock},{k}")
        (tmp_path / f"{name}.csv").write_text("\n".join(lines) + "\n")
    (tmp_path / "dataset.toml").write_text(CARD)
    return tmp_path / "dataset.toml"


def told(card: Path) -> str:
    with pytest.raises(UserError) as refused:
        load_dataset(card)
    return str(refused.value).removeprefix(f"{card}, ")


def test_dates_are_added_to_times_of_day(card: Path) -> None:
    data = load_dataset(card)
    assert np.diff(data.recordings[0].time) == pytest.approx(np.full(149, 0.1), abs=1e-6)
    whole = np.concatenate([recording.signals["y"] for recording in data.recordings])
    assert whole[:199] == pytest.approx(np.arange(199), abs=1e-4), "joined across midnight"
    assert set(joined_files(data)) == {"night", "night (held out)"}


def test_one_file_and_columns_by_position(card: Path) -> None:
    text = CARD.replace('["u.csv", "y.csv"]\njoin = "time"', '"u.csv"').replace(
        'column = "y"', 'column = "u", scale = 1'
    )
    card.write_text(text.replace('column = "clock", date = "day"', "column = 2, date = 1"))
    assert np.ptp(load_dataset(card).recordings[0].time) == pytest.approx(14.9)


def test_without_the_dates_it_is_told_where_they_may_stand(card: Path) -> None:
    card.write_text(CARD.replace(', date = "day"', ""))
    assert (
        'passes midnight here: give stamps with the date (of a column beside it: time = { column = "…", date = "…" })'
        in told(card)
    )


@pytest.mark.parametrize(
    ("instead", "message"),
    [
        (
            'date = "days"',
            '[[experiment]] "night", time: {folder}/u.csv: no column "days" (did you mean "day"?); found day, clock, u',
        ),
        (
            'date = "u"',
            '[[experiment]] "night": {folder}/u.csv, column "u": is no column of dates alone, such as 2026-03-01',
        ),
        ('date = "clock"', 'column "clock": is no column of dates alone'),
    ],
)
def test_a_column_that_has_no_dates(card: Path, instead: str, message: str) -> None:
    card.write_text(CARD.replace('date = "day"', instead))
    assert message.format(folder=card.parent) in told(card)


def test_times_that_have_dates_already(card: Path) -> None:
    for name in ("u", "y"):
        file = card.parent / f"{name}.csv"
        file.write_text(file.read_text().replace(",23:", ",2026-03-01 23:").replace(",00:", ",2026-03-02 00:"))
    assert 'column "clock": is no column of times of day; expected time without date = "…"' in told(card)


def test_a_date_alone_is_its_midnight() -> None:
    assert TimeStamps().seconds("1970-01-02") == TimeStamps().seconds("02.01.1970") == 86400.0
    assert not any(map(is_time_stamp, ("", "2026-03-01T", "2026-03-01 ", "01.03.2026Z")))


@pytest.mark.parametrize(
    "text",
    [
        "02.01.1970 00:05",
        "02.01.70, 00:05",
        "1970-01-02 00:05",
        "1970-01-02 00:05 UTC",
        "1970-01-02 01:05:00+01",
        "1970/01/02 00:05",
        "02-Jan-1970 00:05:00",
        "2 jan 1970 12:05 AM",
        "19700102T0005",
        "19700102T000500Z",
    ],
)
def test_dates_as_they_are_often_written(text: str) -> None:
    """Seen: "no column rises from sample to sample" of dates with hours and minutes."""
    assert TimeStamps().seconds(text) == 86700.0 and is_time_stamp(text)


@pytest.mark.parametrize(
    ("first", "last", "days", "noted"),
    [
        ("13/02/2026 23:50", "14/02/2026 00:00", 20498, False),
        ("02/13/2026 11:50 PM", "02/14/2026 12:00 AM", 20498, False),
        ("03/04/2026 23:50", "04/04/2026 00:00", 20547, True),
        ("04/03/26 23:50", "04/04/26 00:00", 20547, True),
        ("03-04-2026", "04-04-2026", 20547, True),
    ],
)
def test_the_dates_tell_which_number_is_the_day(first: str, last: str, days: int, noted: bool) -> None:
    stamps = TimeStamps([first, first, last])
    assert stamps.seconds(last) == days * 86400.0 and bool(stamps.note) is noted
    with pytest.raises(ValueError, match="which number is the day cannot be told"):
        one_by_one = TimeStamps(["03/04/2026 12:00", "06/05/2026 12:00"])
        one_by_one.seconds("03/04/2026 12:00"), one_by_one.seconds("06/05/2026 12:00")


def test_dates_that_are_not_understood_are_told_as_such(tmp_path: Path) -> None:
    lines = [f"Feb 2 2026 00:{k:02};{k % 7};{k % 5}" for k in range(30)]
    (tmp_path / "run.csv").write_text("\n".join(["Timestamp;u;y", *lines]))
    (told,) = gt.card(tmp_path / "run.csv").open
    assert told.startswith('sample_time: column "Timestamp", line 2: found "Feb 2 2026 00:00"')
    assert "it looks like a date or a time of day; understood are 2026-03-01 12:00, 01.03.2026 12:00" in told
    with pytest.raises(ValueError, match="hours and minutes, or minutes and seconds, may be meant"):
        TimeStamps().seconds("12:00")
