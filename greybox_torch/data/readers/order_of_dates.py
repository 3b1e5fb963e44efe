"""Dates that may be read in two ways: 03/04/2026 is of March or of April, and 26/03/30 may begin with its year."""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import date
from itertools import pairwise

from greybox_torch.data.checks import DAY

NO_DATE = "no such date"
_EPOCH = date(1970, 1, 1).toordinal()
_TWO_DIGITS = re.compile(r"(\d{1,2})([/.])(\d{1,2})\2(\d{2})", re.ASCII)
"""A date of which the year has two digits."""


@dataclass(frozen=True)
class OrderOfDates:
    """What a column tells of dates such as 03/04/2026, the first of which is ``date``.

    Attributes:
        day_first: whether the day comes before the month; None where nothing tells.
        note: what was concluded from dates that follow each other; else empty.
        day: how long a day is in the unit of the column.
    """

    date: str
    day_first: bool | None
    note: str = ""
    day: float = DAY

    @property
    def untold(self) -> bool:
        """Whether samples count from midnight, as the date may be one of two."""
        one, other, _ = numbers_of(self.date)
        return self.day_first is None and one != other


def days_of(either: str, *, day_first: bool) -> int:
    """The days since 1970 of a date such as 03/04/2026. Raises ValueError where there is none such in that order."""
    one, other, year = numbers_of(either)
    return days_to(year, *((other, one) if day_first else (one, other)))


def is_date(either: str, *, day_first: bool) -> bool:
    """Whether there is such a date in that order."""
    try:
        days_of(either, day_first=day_first)
    except ValueError:
        return False
    return True


def days_to(year: int, month: int, day: int) -> int:
    """Days since 1970; a year of two digits, as 26, is 2026. Raises ValueError where there is no such date."""
    try:
        return date(year if year > 99 else year + (2000 if year < 70 else 1900), month, day).toordinal() - _EPOCH
    except ValueError:
        raise ValueError(NO_DATE) from None


def numbers_of(either: str) -> tuple[int, int, int]:
    """The three numbers of a date such as 03/04/2026."""
    one, other, year = (int(number) for number in re.split("[-/]", either))
    return one, other, year


def instead_of_year_first(dates: list[str]) -> str:
    """How to write the first of dates with a year of two digits of which the last number changes as a day does; "" where it does not."""
    found = [match.groups() for one in dict.fromkeys(dates) if (match := _TWO_DIGITS.fullmatch(one))]
    changes = list(pairwise(found))
    first, last = (sum(before[k] != after[k] for before, after in changes) for k in (0, 3))
    if 2 * last <= len(changes) or last <= first:
        return ""
    year, _, month, day = found[0]
    return f"20{int(year):02}-{int(month):02}-{int(day):02}"
