"""Dates and times of day in the place of seconds: "2026-03-01T12:00:00.010", "01.03.2026 12:00", "01-Mar-2026 12:00:00", "12:00:00.010"."""

from __future__ import annotations

import re
from collections.abc import Iterable
from datetime import date

from greybox_torch.data.checks import DAY

UNDERSTOOD = (
    "understood are 2026-03-01 12:00, 01.03.2026 12:00, 13/03/2026 12:00, 03/13/2026 12:00 PM, 01-Mar-2026 12:00 and 20260301T1200, each "
    "with seconds or without, and 12:00:00 alone"
)
"""Of dates, for messages."""

_EPOCH = date(1970, 1, 1).toordinal()
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


class TimeStamps:
    """Turns the time stamps of one column into seconds: since 1970 where they have dates, else since midnight. A date
    alone is its midnight.

    Dates such as 03/04/2026 are of March or of April. Which number is the day is told by one above 12 in ``texts``, those of the column,
    or by dates that follow each other within a day in one of the two orders alone; else they count as long as they are the same one.

    Attributes:
        day_first: whether the day comes before the month in such dates; None where nothing tells.
        note: what was concluded from dates that follow each other, for the user; else empty.
    """

    def __init__(self, texts: Iterable[str] = (), day_first: bool | None = None) -> None:
        self._either: str | None = None
        self.day_first = day_first
        self.note = ""
        if day_first is None:
            self._look_for_the_order(texts)

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
        if found["either"] is not None:
            return self._days_of_two_readings(found["either"])
        day, year = (next(filter(None, (found[n], found[n + "2"], found[n + "3"]))) for n in "dy")
        month = _month(found["name"]) if found["name"] else int(found["m"] or found["m2"])
        return date(_year(year), month, int(day)).toordinal() - _EPOCH

    def _days_of_two_readings(self, either: str) -> int:
        one, other, year = map(int, re.split("[-/]", either))
        if self.day_first is None:
            self._either = self._either or either
            if either != self._either:
                raise ValueError(
                    "which number is the day cannot be told; expected a date like 2026-03-01, or an experiment for each day"
                )
            if one != other:
                return 0
        day, month = (one, other) if self.day_first else (other, one)
        return date(_year(str(year)), month, day).toordinal() - _EPOCH

    def _look_for_the_order(self, texts: Iterable[str]) -> None:
        matches = ((text, found["either"]) for text in texts if (found := _match(text)) and found["either"])
        at_changes: list[tuple[str, str]] = []
        first = before = None
        for text, either in matches:
            first = first or (text, either)
            if before is not None and either != before[1]:
                at_changes.append((before[0], text))
            before = text, either
        if first is None:
            return
        steps = {order: _steps(first[0], at_changes, day_first=order) for order in (True, False)}
        possible = [order for order in steps if steps[order] is not None]
        within = [order for order in possible if at_changes and all(0.0 < s <= DAY for s in steps[order] or ())]
        if len(possible) == 1:
            self.day_first = possible[0]
        elif len(within) == 1:
            self.day_first = within[0]
            order = "day before month" if within[0] else "month before day"
            self.note = f'dates such as "{first[1]}" are read with the {order}, as they follow each other so'


def is_time_stamp(text: str) -> bool:
    """Whether a text is a date, a time of day, or both."""
    try:
        TimeStamps().seconds(text)
    except ValueError:
        found = _match(text)
        return found is not None and found["either"] is not None and _possible(text)
    return True


def looks_like_a_date(text: str) -> bool:
    """Whether a text is likely meant as a date or a time of day, be it understood or not."""
    return _LIKE_A_DATE.fullmatch(text) is not None


def _match(text: str) -> re.Match[str] | None:
    if text[8:9] == "T" and (plain := _WITHOUT_SIGNS.fullmatch(text)):
        year, month, day, hour, minute, second, zone = plain.groups("")
        text = f"{year}-{month}-{day}T{hour}:{minute}:{second or '00'}{zone}"
    return _STAMP.fullmatch(text) if text else None


def _dated(found: re.Match[str]) -> bool:
    return found["date"] is not None


def _steps(first: str, at_changes: Iterable[tuple[str, str]], *, day_first: bool) -> list[float] | None:
    """The seconds from one date to the next; None where one of them is no date in that order."""
    stamps = TimeStamps(day_first=day_first)
    try:
        stamps.seconds(first)
        return [stamps.seconds(after) - stamps.seconds(before) for before, after in at_changes]
    except ValueError:
        return None


def _possible(text: str) -> bool:
    return any(_steps(text, (), day_first=order) is not None for order in (True, False))


def _month(name: str) -> int:
    month = _MONTHS.get(name[:3].lower())
    if month is None:
        raise ValueError(f'"{name}" is no month; {UNDERSTOOD}')
    return month


def _year(text: str) -> int:
    """Of two digits, as 26, the year 2026."""
    year = int(text)
    return year if year > 99 else year + (2000 if year < 70 else 1900)


def _offset(zone: str | None) -> float:
    """Seconds by which a time zone is ahead."""
    if zone in (None, "Z", "UTC", "GMT"):
        return 0.0
    assert zone is not None
    ahead = 3600.0 * int(zone[1:3]) + 60.0 * int(zone[3:].lstrip(":") or 0)
    return -ahead if zone[0] == "-" else ahead
