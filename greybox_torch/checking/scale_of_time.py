"""Time stamps that are likely in another unit than the card says, by the times of the machine and by how long anybody records."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from greybox_torch.data import DataSet
from greybox_torch.data.card import card_at
from greybox_torch.data.card_channels import TimeEntry
from greybox_torch.data.data_warning import InASentence
from greybox_torch.data.readers import read_table
from greybox_torch.errors import UserError
from greybox_torch.files import toml_text

_COARSE = 20.0
"""Slowest time constants that a sample time is at least where hardly anything of the machine's motion can be in the recording."""
_FINE = 0.5
"""Of that time constant: what a sample time would be at most."""
_SHOWN = 0.05
"""Likewise: what a recording would last at least."""
_YEAR = 365.25 * 86400.0
_DECADE = 10.0


@dataclass(frozen=True)
class ScaleOfTime(InASentence):
    """What is odd about the unit of time, in a sentence, and what to write."""

    found: str
    write: str


def decades(data: DataSet) -> Iterator[ScaleOfTime]:
    """The longest experiment, where it lasts ten years and more."""
    longest = max(data.recordings, key=lambda recording: recording.seconds, default=None)
    if longest is None or longest.seconds < _DECADE * _YEAR:
        return
    time = numeric_time(data)
    smaller = [unit for unit in ("ms", "us", "ns") if time is not None and _ratio(unit, time) < 1.0]
    yield ScaleOfTime(
        f'[[experiment]] "{longest.name}": lasts {longest.seconds / _YEAR:.3g} years, with a sample time of {longest.sample_time:.4g} s',
        _written(time, smaller) or "time stamps, or a sample time, in s",
    )


def coarse(data: DataSet, constant: float | None) -> Iterator[ScaleOfTime]:
    """The finest sample time, where even that is far above the slowest time constant of the model, in s."""
    finest = min((recording.sample_time for recording in data.recordings), default=0.0)
    if constant is None or finest < _COARSE * constant:
        return
    time = numeric_time(data)
    fine = [] if time is None else [u for u in ("ms", "us") if _ratio(u, time) * finest <= _FINE * constant]
    yield ScaleOfTime(
        f"[[experiment]]: the sample time, {finest:.4g} s, is {finest / constant:.3g} times the slowest time constant, {constant:.3g} s by "
        "the model's values: nothing of how the machine gets from one state to another is in the recording",
        _written(time, fine) or "a sample time in s, or other start values of the parameters",
    )


def in_larger_units(data: DataSet, constant: float) -> str:
    """What to write of recordings that are short beside a time constant, in s, where a larger unit of the stamps explains it; else ""."""
    time = numeric_time(data)
    longest = max((recording.seconds for recording in data.estimation()), default=0.0)
    if time is None:
        return ""
    larger = [u for u in ("s", "min", "h") if _ratio(u, time) > 1.0 and _ratio(u, time) * longest >= _SHOWN * constant]
    return _written(time, larger)


def numeric_time(data: DataSet) -> TimeEntry | None:
    """The time stamps of the first experiment on the card; None where there is no card or column, or where it has dates, whose unit is
    known.
    """
    try:
        card = card_at(data.path)
        first = card.experiment[0] if card else None
        time = card.of(first).time if card and first else None
        if time is None or first is None or data.path is None or time.date is not None:
            return None
        dated = time.column in read_table(data.path.parent / first.file[0], (time.column,)).stamps
    except UserError:  # the card or the file was replaced meanwhile
        return None
    return None if dated else time


def _ratio(unit: str, time: TimeEntry) -> float:
    return time.model_copy(update={"unit": unit}).seconds / time.seconds


def _written(time: TimeEntry | None, units: list[str]) -> str:
    if time is None or not units:
        return ""
    entries = [f"{{ column = {toml_text(time.column)}, unit = {toml_text(unit)} }}" for unit in units]
    return f"time = {' or '.join(entries)}, if the stamps are so"
