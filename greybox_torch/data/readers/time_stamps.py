"""Dates and times of day in the place of seconds: "2026-03-01T12:00:00.010", "01.03.2026 12:00:00,010", "12:00:00.010"."""

from __future__ import annotations

import re
from datetime import date

from greybox_torch.data.checks import DAY

_EPOCH = date(1970, 1, 1).toordinal()
_STAMP = re.compile(
    r"""(?:(?P<date>(?P<y>\d{4})[-/](?P<m>\d{1,2})[-/](?P<d>\d{1,2}) | (?P<d2>\d{1,2})\.(?P<m2>\d{1,2})\.(?P<y2>\d{4})
            | (?P<either>\d{1,2}/\d{1,2}/\d{4}))(?:[T ]\ ?(?=\d)|$))?
        (?:(?P<hour>\d{1,2}):(?P<minute>\d{2}):(?P<second>\d{2}(?:[.,]\d{1,12})?)
        (?:\ ?(?P<half>[AaPp])[Mm])?
        (?:\ ?(?P<zone>Z|[+-]\d{2}:?\d{2}))?)?""",
    re.VERBOSE | re.ASCII,
)


class TimeStamps:
    """Turns the time stamps of one column into seconds: since 1970 where they have dates, else since midnight. A date
    alone is its midnight.

    Dates such as 03/04/2026 are of March or of April, who knows: they count as long as they are the same one.
    """

    def __init__(self) -> None:
        self._either: str | None = None

    def seconds(self, text: str) -> float:
        """Raises ValueError for what is no time stamp, and for a date that may be one of two."""
        minute, seconds = self.minute_and_seconds(text)
        return minute + seconds

    def minute_and_seconds(self, text: str) -> tuple[float, float]:
        """The seconds to the minute, a whole number, and those from it on: together they hold more digits than their sum, a quarter of a
        microsecond since 1970. Raises ValueError as :meth:`seconds` does.
        """
        found = _STAMP.fullmatch(text)
        if found is None or not text:
            raise ValueError("expected a time stamp like 2026-03-01T12:00:00.010")
        if found["hour"] is None:
            return self._days(found) * DAY, 0.0
        hour, minute, second = int(found["hour"]), int(found["minute"]), float(found["second"].replace(",", "."))
        if found["half"] is not None:
            hour = hour % 12 + 12 * (found["half"] in "Pp")
        if hour > 23 or minute > 59 or second >= 61.0:
            raise ValueError("no such time of day")
        return self._days(found) * DAY + 3600.0 * hour + 60.0 * minute - _offset(found["zone"]), second

    def _days(self, found: re.Match[str]) -> int:
        if found["date"] is None:
            return 0
        if found["either"] is not None:
            self._either = self._either or found["either"]
            if found["either"] != self._either:
                raise ValueError("which number is the day cannot be told; expected a date like 2026-03-01")
            return 0
        year, month, day = (int(found[n] or found[n + "2"]) for n in "ymd")
        return date(year, month, day).toordinal() - _EPOCH


def is_time_stamp(text: str) -> bool:
    """Whether a text is a date, a time of day, or both."""
    try:
        TimeStamps().seconds(text)
    except ValueError:
        return False
    return True


def _offset(zone: str | None) -> float:
    """Seconds by which a time zone is ahead."""
    if zone in (None, "Z"):
        return 0.0
    assert zone is not None
    ahead = 3600.0 * int(zone[1:3]) + 60.0 * int(zone[-2:])
    return -ahead if zone[0] == "-" else ahead
