"""Dates and times of day in the place of seconds: "2026-03-01T12:00:00.010", "01.03.2026 12:00", "01-Mar-2026 12:00:00", "12:00:00.010"."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

from greybox_torch.data.checks import DAY
from greybox_torch.data.readers.order_of_dates import (
    NO_DATE,
    OrderOfDates,
    days_of,
    days_to,
    instead_of_year_first,
    is_date,
    numbers_of,
)

UNDERSTOOD = (
    "understood are 2026-03-01 12:00, 01.03.2026 12:00, 13/03/2026 12:00, 03/13/2026 12:00 PM, 01-Mar-2026 12:00 and 20260301T1200, each "
    "with seconds or without, and 12:00:00 alone"
)
"""Of dates, for messages."""

_STAMP = re.compile(
    r"""(?:(?P<date>(?P<y>\d{4})[-/](?P<m>\d{1,2})[-/](?P<d>\d{1,2}) | (?P<d2>\d{1,2})\.(?P<m2>\d{1,2})\.(?P<y2>\d{4}|\d{2})
            | (?P<d3>\d{1,2})[- ](?P<name>[A-Za-zä]{3,9})\.?[- ](?P<y3>\d{4})
            | (?P<either>\d{1,2}/\d{1,2}/(?:\d{4}|\d{2})|\d{1,2}-\d{1,2}-\d{4}))
            (?:(?:T|,?\ ){1,2}(?=\d)|$))?
        (?:(?P<hour>\d{1,2}):(?P<minute>\d{2})(?::(?P<second>\d{2}(?:[.,]\d{1,12})?))?
        (?:\ ?(?P<half>[AaPp])[Mm])?
        (?:\ ?(?P<zone>Z|UTC|GMT|[+-]\d{2}:?\d{2}|[+-]\d{2}))?)?""",
    re.VERBOSE | re.ASCII,
)
_WITHOUT_SIGNS = re.compile(r"(\d{4})(\d\d)(\d\d)T(\d\d)(\d\d)(\d\d(?:[.,]\d{1,12})?)?(Z|[+-]\d\d:?\d\d)?", re.ASCII)
_LIKE_A_DATE = re.compile(
    r"\d{1,4}([-/. ])(\d{1,2}|[^\W\d_]{3,9}\.?)\1\d{2,4}(\D.*)?|\d{1,2}:\d\d(\D.*)?|[^\W\d_]{3,9}\.?,? \d{1,2}\D.*\d{4}.*"
)
_MONTHS = {
    name: month
    for month, name in enumerate(
        ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"), 1
    )
} | {"mär": 3, "mrz": 3, "mai": 5, "okt": 10, "dez": 12}


@dataclass
class _Day:
    """Samples of one ``date`` that follow each other, the first and the last; ``either``: the date may be one of two."""

    date: str
    either: bool
    first: str
    last: str


class TimeStamps:
    """Turns the time stamps of one column into seconds: since 1970 where they have dates, else since midnight. A date
    alone is its midnight.

    Dates such as 03/04/2026 are of March or of April. Which number is the day is told by one above 12 in ``texts``, those of the column,
    or by dates that follow each other within a day in one of the two orders alone; else they count as long as they are the same one.

    Attributes:
        day_first: whether the day comes before the month in such dates; None where nothing tells.
        note: what was concluded from dates that follow each other, for the user; else empty.
        order: the same for further files, of which each may have one date alone; None where no date is of that kind.
    """

    def __init__(self, texts: Iterable[str] = (), day_first: bool | None = None) -> None:
        self._either: str | None = None
        self.day_first = day_first
        self.note = ""
        self.order: OrderOfDates | None = None
        self._year_first = ""
        if day_first is None:
            days = _days_in(texts)
            self._year_first = instead_of_year_first([day.date for day in days])
            self._look_for_the_order([day for day in days if day.either])

    def seconds(self, text: str) -> float:
        """Raises ValueError for what is no time stamp, and for a date that may be one of two."""
        minute, seconds = self.minute_and_seconds(text)
        return minute + seconds

    def minute_and_seconds(self, text: str) -> tuple[float, float]:
        """The seconds to the minute, a whole number, and those from it on: together they hold more digits than their sum, a quarter of a
        microsecond since 1970. Raises ValueError as :meth:`seconds` does.
        """
        found = _match(text)
        if found is None:
            like_a_date = f"; it looks like a date or a time of day; {UNDERSTOOD}" if looks_like_a_date(text) else ""
            raise ValueError(f"expected a time stamp like 2026-03-01T12:00:00.010{like_a_date}")
        if found["hour"] is None:
            return self._days(found) * DAY, 0.0
        if found["second"] is None and found["half"] is None and not _dated(found):
            raise ValueError(
                "expected a time stamp like 12:00:00: hours and minutes, or minutes and seconds, may be meant"
            )
        second = float((found["second"] or "0").replace(",", "."))
        hour, minute = int(found["hour"]), int(found["minute"])
        if found["half"] is not None:
            hour = hour % 12 + 12 * (found["half"] in "Pp")
        if hour > 23 or minute > 59 or second >= 61.0:
            raise ValueError("no such time of day")
        return self._days(found) * DAY + 3600.0 * hour + 60.0 * minute - _offset(found["zone"]), second

    def _days(self, found: re.Match[str]) -> int:
        if not _dated(found):
            return 0
        if self._year_first:
            raise ValueError(
                f"the last number changes as the day does where the year comes first; expected a date like {self._year_first}"
            )
        if found["either"] is not None:
            return self._days_of_two_readings(found["either"])
        day, year = (next(filter(None, (found[n], found[n + "2"], found[n + "3"]))) for n in "dy")
        month = _month(found["name"]) if found["name"] else int(found["m"] or found["m2"])
        return days_to(int(year), month, int(day))

    def _days_of_two_readings(self, either: str) -> int:
        one, other, _ = numbers_of(either)
        if self.day_first is None:
            if not any(is_date(either, day_first=order) for order in (True, False)):
                raise ValueError(NO_DATE)
            self._either = self._either or either
            if either != self._either:
                raise ValueError(
                    "which number is the day cannot be told; expected a date like 2026-03-01, or an experiment for each day"
                )
            if one != other:
                return 0
        return days_of(either, day_first=self.day_first is not False)

    def _look_for_the_order(self, days: list[_Day]) -> None:
        """From the dates of two readings."""
        if not days:
            return
        possible: tuple[bool, ...] = (True, False)
        for day in days:
            left = tuple(order for order in possible if is_date(day.date, day_first=order))
            if not left:  # refused where it is read
                break
            possible = left
        at_changes = [(before.last, after.first) for before, after in pairwise(days)]
        steps = {order: _steps(at_changes, day_first=order) for order in possible}
        within = [order for order in steps if at_changes and all(0.0 < s <= DAY for s in steps[order])]
        if len(possible) == 1:
            self.day_first = possible[0]
        elif len(within) == 1:
            self.day_first = within[0]
            order = "day before month" if within[0] else "month before day"
            self.note = f'dates such as "{days[0].date}" are read with the {order}, as they follow each other so'
        self.order = OrderOfDates(days[0].date, self.day_first, self.note)


def is_time_stamp(text: str) -> bool:
    """Whether a text is a date, a time of day, or both."""
    try:
        TimeStamps().seconds(text)
    except ValueError:
        return False
    return True


def looks_like_a_date(text: str) -> bool:
    """Whether a text is likely meant as a date or a time of day, be it understood or not."""
    return _LIKE_A_DATE.fullmatch(text) is not None


def _match(text: str) -> re.Match[str] | None:
    if text[8:9] == "T" and (plain := _WITHOUT_SIGNS.fullmatch(text)):
        year, month, day, hour, minute, second, zone = plain.groups("")
        text = f"{year}-{month}-{day}T{hour}:{minute}:{second or '00'}{zone}"
    return _STAMP.fullmatch(text) if text else None


def _days_in(texts: Iterable[str]) -> list[_Day]:
    """Few, of however many samples: these may be millions."""
    days: list[_Day] = []
    for text in texts:
        found = _match(text)
        if found is None or not _dated(found):
            continue
        if days and days[-1].date == found["date"]:
            days[-1].last = text
        else:
            days.append(_Day(found["date"], found["either"] is not None, text, text))
    return days


def _dated(found: re.Match[str]) -> bool:
    return found["date"] is not None


def _steps(at_changes: Iterable[tuple[str, str]], *, day_first: bool) -> list[float]:
    """The seconds from one date to the next; of none, where one of them has no such date or time of day."""
    stamps = TimeStamps(day_first=day_first)
    try:
        return [stamps.seconds(after) - stamps.seconds(before) for before, after in at_changes]
    except ValueError:
        return [float("nan")]


def _month(name: str) -> int:
    month = _MONTHS.get(name[:3].lower())
    if month is None:
        raise ValueError(f'"{name}" is no month; {UNDERSTOOD}')
    return month


def _offset(zone: str | None) -> float:
    """Seconds by which a time zone is ahead."""
    if zone in (None, "Z", "UTC", "GMT"):
        return 0.0
    assert zone is not None
    ahead = 3600.0 * int(zone[1:3]) + 60.0 * int(zone[3:].lstrip(":") or 0)
    return -ahead if zone[0] == "-" else ahead
