"""Local time that is set to summer time and back: its stamps jump by an hour in a night to a Sunday of spring or autumn."""

from __future__ import annotations

from datetime import UTC, datetime

_HOUR = 3600.0
_DATES = (3e8, 5e9)
"""Seconds since 1970 that stamps with a date have; others count from some start."""
_MONTHS = (3, 4, 9, 10, 11)
_SUNDAY = 6
_LATEST = 4  # o'clock


def clock_set_forward(before: float, after: float, step: float) -> bool:
    """Whether stamps (s since 1970) that follow each other, usually a ``step`` apart, lie on both sides of the hour that is left out."""
    return abs(after - before - step - _HOUR) <= 0.5 * step and _in_such_a_night(before)


def clock_set_back(before: float, after: float, step: float) -> bool:
    """As :func:`clock_set_forward`, of the hour that comes twice."""
    return abs(before - after + step - _HOUR) <= 0.5 * step and _in_such_a_night(after)


def written_date(seconds: float) -> str:
    """Seconds since 1970 as date and time of day, as "2026-03-01 12:00:00"; "" where they count from elsewhere."""
    return f"{datetime.fromtimestamp(round(seconds), UTC):%Y-%m-%d %H:%M:%S}" if _has_a_date(seconds) else ""


def instead_of_summer_time(step: float) -> str:
    """What to do about local time that is set to summer time or back, to go on with; samples are usually ``step`` s apart."""
    return (
        f"time stamps in UTC or with a time zone in that file (2026-03-29T03:00:00+02:00), or sample_time = {step:.6g} in the place of "
        "time if no file of the card has a gap"
    )


def _has_a_date(seconds: float) -> bool:
    return _DATES[0] < seconds < _DATES[1]


def _in_such_a_night(seconds: float) -> bool:
    if not _has_a_date(seconds):
        return False
    at = datetime.fromtimestamp(seconds, UTC)
    return at.weekday() == _SUNDAY and at.month in _MONTHS and at.hour < _LATEST
