"""When samples were taken: a column of time stamps, a sample time that stands in the file, or neither."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.column_units import without_ending
from greybox_torch.data.counts import counts_samples
from greybox_torch.data.gaps import Gap, longest_gap
from greybox_torch.data.readers.time_stamps import UNDERSTOOD
from greybox_torch.data.steps import EVEN, even_step, unevenness
from greybox_torch.data.summer_time import clock_set_back, instead_of_summer_time
from greybox_torch.data.time_units import unit_of_time
from greybox_torch.drafting.matching import words
from greybox_torch.drafting.recorded import Recorded

_TIME = re.compile(
    r"(^|[\W_])(t|times?|(time_?)?stamps?|date_?times?|date_?time_?stamps?|dates?|tid|dato|zeit|zeit_?(stempel|punkt)|uhr_?zeit|datum|temps|"
    r"horodatage|horodate|heure|fecha|hora|data_?ora|orario|tijd|tijdstip|seconds|secs?|millis|clock|(?-i:ts)|epoch|unix|elapsed)($|[\W_\d])",
    re.IGNORECASE,
)
_STEP = re.compile(r"^(ts|dt|h|tsampl|t_s|sample_?time|sampling_?time|sample_?period|step|delta_?t)$", re.IGNORECASE)
_RATE = re.compile(r"^(fs|f_s|fps|rate|(sample|frame)_?rate|sampling_?(rate|frequency)|frequency)$", re.IGNORECASE)
_UNITS = {
    "ns": re.compile(r"(^|[\W_])(ns|nsec|nanos\w*)($|[\W_])", re.IGNORECASE),
    "us": re.compile(r"(^|[\W_])(us|µs|usec|micros\w*)($|[\W_])", re.IGNORECASE),
    "ms": re.compile(r"(^|[\W_])(ms|msec|millis\w*)($|[\W_])", re.IGNORECASE),
    "min": re.compile(r"(^|[\W_])(min|minutes)($|[\W_])", re.IGNORECASE),
}
SECONDS = {"ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}
"""Of the units of time stamps that are none themselves."""
_SINCE_1970 = {"ns": 1e17, "us": 1e14, "ms": 1e11}
"""Time stamps of our days are larger than this in that unit."""

_EVEN_ENOUGH = 0.5
"""Steps of a clock without a name of its own differ by less than this share of the median."""

_SOME = 0.1
"""Share of samples up to which a column that is called like time stamps, and does not rise in these, was meant as that."""


@dataclass(frozen=True)
class Clock:
    """Either ``column`` (None: there is none) with its unit, or ``sample_time`` in seconds (None: not known).

    ``remark`` says what the guess is from; ``uneven`` the step in s of an even grid where the steps differ, but for gaps, else empty;
    ``gap`` is the longest gap. ``broken`` says where the column does not rise and the file is to be mended, else it is empty. ``date`` is
    the column of the dates of times of day, else empty. ``said`` is whether anything says the unit. ``position`` is that of the column,
    from 1 on, where a card names it so (None: by its name).
    """

    column: str | None = None
    unit: str = "s"
    sample_time: float | None = None
    remark: str = ""
    uneven: str = ""
    gap: Gap | None = None
    broken: str = ""
    date: str = ""
    said: bool = True
    position: int | None = None

    @property
    def seconds(self) -> float:
        """A unit of the column in s."""
        return SECONDS.get(self.unit, 1.0)

    @property
    def written(self) -> tuple[str | None, str, str]:
        """What a card says of it."""
        return self.column, self.unit, self.date

    @property
    def on_card(self) -> str | int | None:
        """The column as a card names it: by its name, or by its position."""
        return self.column if self.position is None else self.position


def clock_of(file: Recorded, channels: Collection[str] = ()) -> Clock:
    """The clock of a file, as far as names and numbers tell.

    Args:
        channels: of the model. A column that is called as one of them is no clock for rising evenly, as an input may; neither is the only
            column of a file.
    """
    clock = _without_date(file, [words(channel) for channel in channels])
    date = file.dates.get(clock.column or "", "")
    order = file.orders.get(date or clock.column or "")
    told = f"; {order.note}" if order and order.note and not clock.broken else ""
    return replace(clock, date=date, remark=f"{clock.remark}{told}")


def _without_date(file: Recorded, channels: Collection[list[str]]) -> Clock:
    rising = {name: values for name, values in file.columns.items() if _rises(values)}
    named = [name for name in rising if name in file.stamps or named_like_a_clock(name)]
    free = [name for name in rising if len(file.columns) > 1 and words(without_ending(name)) not in channels]
    counters = [name for name in free if counts_samples(without_ending(name), rising[name])]
    free = [name for name in free if name not in counters]
    other = [name for name in free if is_clock(rising[name]) and _comes_first(name, file)]
    for column in (*named, *other):
        return _clock(column, rising[column], file.units.get(column, ""))
    for name, value in file.numbers.items():
        last = name.rsplit(".", 1)[-1]
        if value > 0 and _STEP.match(last):
            return Clock(sample_time=value, remark=f"{name} = {value:g} in {file.path.name}")
        if value > 0 and _RATE.match(last):
            return Clock(sample_time=1.0 / value, remark=f"1 / {name}, {name} = {value:g} in {file.path.name}")
    return _broken(file) or Clock(
        remark=f"{_not_read(file)}{_counting(counters)}no column rises from sample to sample, and no number is called Ts, dt or fs"
    )


def _counting(counters: Sequence[str]) -> str:
    """Of a column that was taken for no time as it counts samples, to go on with; else ""."""
    return f'column "{counters[0]}" counts samples, and is no time; ' if counters else ""


def _not_read(file: Recorded) -> str:
    """Of a column of dates in another form than those that are understood, to go on with; else ""."""
    for name, fault in file.faults.items():
        if name not in file.columns and UNDERSTOOD in fault:
            return f'column "{name}", {fault}; '
    return ""


def _broken(file: Recorded) -> Clock | None:
    """The column that was likely meant, where it rises but for a few samples; one of dates that rises nowhere near that is told."""
    for name, values in file.columns.items():
        falls = np.flatnonzero(~(np.diff(values) > 0))
        nearly = len(falls) < _SOME * len(values)
        if not len(falls) or not (name in file.stamps or (nearly and named_like_a_clock(name))):
            continue
        line = f"{file.where(int(falls[0]) + 1)} is no later than the one before"
        told = f'column "{name}" does not rise everywhere: {line}'
        if not nearly:
            return Clock(remark=f"{told}, and no number is called Ts, dt or fs")
        told = f'column "{name}", {file.faults[name]}' if name in file.faults else told
        unit, _ = _unit(name, values[np.isfinite(values)], file.units.get(name, ""))
        told += _set_back(values, int(falls[0])) if name in file.stamps else ""
        broken = f"{told}; to be mended in {file.path.name}"
        return Clock(name, unit or "s", remark=broken, broken=broken)
    return None


def _set_back(values: NDArray[np.float64], fall: int) -> str:
    """Of stamps (N,) that fall behind a sample as local time does in autumn, to go on with; else ""."""
    step = float(np.nanmedian(np.diff(values)))
    if not clock_set_back(values[fall], values[fall + 1], step):
        return ""
    return f", as where local time is set back from summer time: expected {instead_of_summer_time(step)}"


def _comes_first(column: str, file: Recorded) -> bool:
    """Whether a column is the first of the file, or of a matrix in it, which is where loggers have the time."""
    return column == next(iter(file.columns)) or column.endswith(("[:, 0]", "[0, :]"))


def named_like_a_clock(column: str) -> bool:
    """Whether a column is called like time stamps."""
    return bool(_TIME.search(column))


def is_clock(values: NDArray[np.float64], *, gaps: bool = True) -> bool:
    """Whether values (N,) rise from sample to sample, in steps that hardly differ; without ``gaps``, but for those that are gaps."""
    return _rises(values) and unevenness(values, gaps=gaps) < _EVEN_ENOUGH


def _clock(column: str, values: NDArray[np.float64], unit: str) -> Clock:
    known, why = _unit(column, values, unit)
    step = float(np.median(np.diff(values)))
    doubt = '; if the stamps are milliseconds, unit = "ms"' if not known and step >= 0.5 and step.is_integer() else ""
    seconds = values * SECONDS.get(known, 1.0)
    uneven = even_step(seconds) if unevenness(values, gaps=False) > EVEN else ""
    remark = f"{why}{_step(step, values, known or 's')}{doubt}"
    return Clock(column, known or "s", remark=remark, uneven=uneven, gap=longest_gap(seconds), said=bool(known))


def _unit(column: str, values: NDArray[np.float64], unit: str) -> tuple[str, str]:
    """The unit of time stamps, empty where nothing tells it, and how it is told."""
    if known := unit_of_time(unit):
        return known, f"read in {known}; "
    for known, pattern in _UNITS.items():
        if pattern.search(column):
            return known, "by its name; "
    for known, least in _SINCE_1970.items():
        if values[0] > least:
            return known, "by its size, since 1970; "
    return "", ""


def _step(step: float, values: NDArray[np.float64], unit: str) -> str:
    """The step, with as many digits as stamps as large as ``values`` hold of it: seconds since 1970 hold no nanoseconds."""
    held = math.floor(math.log10(step / float(np.spacing(np.abs(values).max()))))
    return f"steps of {step:.{min(max(held, 1), 6)}g} {unit}"


def _rises(values: NDArray[np.float64]) -> bool:
    return len(values) > 1 and bool(np.isfinite(values).all() and (np.diff(values) > 0).all())
