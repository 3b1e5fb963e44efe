"""Samples from what is in memory already: arrays, and tables of any library. Pandas is not needed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.card import TIME
from greybox_torch.data.checks import NotANumber, check_finite, check_length, check_time, numbers
from greybox_torch.data.readers.time_stamps import TimeStamps
from greybox_torch.data.single_numbers import constant, is_number
from greybox_torch.data.steps import usual_step
from greybox_torch.errors import UserError, did_you_mean


@dataclass(frozen=True)
class Samples:
    """Checked samples of one experiment: time (N,) in s, the step in s, arrays (N,) by channel, units by channel. ``notes`` say how
    dates were read.
    """

    time: NDArray[np.float64]
    sample_time: float
    signals: dict[str, NDArray[np.float64]]
    units: dict[str, str]
    constants: frozenset[str]
    notes: tuple[str, ...] = ()


def samples_of_arrays(
    name: str,
    signals: Mapping[str, Any],
    *,
    sample_time: float | None,
    time: Any,
    units: Mapping[str, str] | None,
) -> Samples:
    """What `Recording.from_arrays` describes."""
    place = _place(name)
    _check_clock(place, sample_time, time is not None)
    if not isinstance(signals, Mapping) or not signals:
        raise UserError(
            f"{place}, signals: found {_shown(signals)}, expected arrays by channel, like {{'voltage': u, 'speed': y}}"
        )
    constants = {
        _channel(place, name): constant(place, name, value) for name, value in signals.items() if is_number(value)
    }
    held = {
        _channel(place, name): _signal(place, name, values) for name, values in signals.items() if name not in constants
    }
    if not held:
        raise UserError(f"{place}, signals: found one number for every channel, expected an array of one at least")
    stamps, notes = (None, ()) if time is None else _seconds(time, f"{place}, time")
    length = _common_length(place, held | ({} if stamps is None else {TIME: stamps}))
    check_length(length, place)
    if stamps is None:
        assert sample_time is not None
        step, stamps = float(sample_time), np.arange(length, dtype=np.float64) * sample_time
    else:
        check_time(stamps, lambda k: f"{place}, time, sample {k} (the first is 0)")
        step = usual_step(stamps)
    held = {name: np.full(length, constants[name]) if name in constants else held[name] for name in signals}
    return Samples(stamps, step, held, _units(place, units, held), frozenset(constants), notes)


def samples_of_frame(
    name: str,
    frame: Any,
    *,
    time: str | None,
    sample_time: float | None,
    units: Mapping[str, str] | None,
    columns: Mapping[str, str] | None,
    constants: Mapping[str, float] | None = None,
) -> Samples:
    """What `Recording.from_dataframe` describes."""
    place = _place(name)
    _check_clock(place, sample_time, time is not None, _of_index(frame))
    found = _column_names(place, frame)
    wanted = {str(n): n for n in found if n != time} if columns is None else dict(columns)
    if not wanted:
        raise UserError(f"{place}, frame: has no column beside {time!r}; expected one for every channel")
    for argument, column in [*(("columns", c) for c in wanted.values()), ("time", time)]:
        if column is not None and column not in found:
            listed = ", ".join(map(str, found))
            raise UserError(
                f"{place}, {argument}: frame has no column {column!r}{did_you_mean(str(column), map(str, found))}; found {listed}"
            )
    for channel, value in (constants or {}).items():
        if channel in wanted:
            raise UserError(f'{place}, constants: "{channel}" has a column as well; expected one of them')
        if not is_number(value):
            raise UserError(f'{place}, constants: found {_shown(value)} for "{channel}", expected a number')
    signals = {channel: _values(frame, column) for channel, column in wanted.items()} | dict(constants or {})
    stamps = None if time is None else _values(frame, time)
    try:
        return samples_of_arrays(name, signals, sample_time=sample_time, time=stamps, units=units)
    except NotANumber as error:
        if columns is not None:
            raise
        advice = "every column of the frame is a channel, but where columns = {channel: column} names those to read"
        raise UserError(f"{error}; {advice}") from None


def _place(name: Any) -> str:
    if not isinstance(name, str) or not name:
        raise UserError(f"Recording, name: found {_shown(name)}, expected text that is not empty")
    return f'recording "{name}"'


def _of_index(frame: Any) -> str:
    """What to do where a table's times are in its index, which is no column; "" elsewhere."""
    index = getattr(frame, "index", None)
    if not str(getattr(index, "dtype", "")).startswith(("datetime64", "timedelta64")):
        return ""
    name = getattr(index, "name", None) or "index"
    return f"; its index holds times, which frame.reset_index() makes a column: time={name!r}"


def _check_clock(place: str, sample_time: Any, has_time: bool, hint: str = "") -> None:
    if sample_time is None:
        if not has_time:
            raise UserError(
                f"{place}: sample_time is missing; expected sample_time (seconds), or time (the time stamps){hint}"
            )
        return
    if has_time:
        raise UserError(f"{place}: both sample_time and time are given; expected one of them")
    number = isinstance(sample_time, int | float | np.integer | np.floating) and not isinstance(sample_time, bool)
    if not number or not 0 < sample_time < math.inf:
        raise UserError(f"{place}, sample_time: found {_shown(sample_time)}, expected a number above zero, in seconds")


def _channel(place: str, channel: Any) -> str:
    if not isinstance(channel, str) or not channel:
        raise UserError(f"{place}, signals: found a channel named {_shown(channel)}, expected text that is not empty")
    if channel == TIME:
        raise UserError(f'{place}, signals: "{TIME}" cannot name a channel; time stamps are the argument time')
    return channel


def _signal(place: str, channel: str, values: Any) -> NDArray[np.float64]:
    where = f'{place}, channel "{channel}"'
    found = numbers(values, where)
    check_finite(found, lambda k: f"{where}, sample {k} (the first is 0)")
    if found.size and np.isnan(found).all():
        raise UserError(f"{where}: all {len(found)} samples are missing (NaN); expected numbers")
    return found


def _seconds(time: Any, where: str) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """Time stamps in seconds, and notes; dates and times count from the first of them."""
    stamps = time if np.ma.isMaskedArray(time) or hasattr(time, "detach") else np.asarray(time)
    if isinstance(stamps, np.ma.MaskedArray) and stamps.dtype.kind in "mM":
        stamps = np.where(np.ma.getmaskarray(stamps), np.array("NaT", dtype=stamps.dtype), stamps.data)
    if isinstance(stamps, np.ndarray) and stamps.dtype.kind in "mM" and stamps.ndim == 1 and stamps.size:
        if np.datetime_data(stamps.dtype)[0] in ("Y", "M"):  # these are of no length that is always the same
            if stamps.dtype.kind == "m":
                raise UserError(
                    f"{where}: holds {stamps.dtype}; expected seconds, or timedelta64 in weeks, days or shorter"
                )
            stamps = stamps.astype("datetime64[s]")
        since = stamps - stamps[0] if stamps.dtype.kind == "M" else stamps
        seconds = since / np.timedelta64(1, "s")
        return np.where(np.isnat(stamps), np.nan, seconds), ()
    dated = isinstance(stamps, np.ndarray) and stamps.dtype.kind == "O" and stamps.ndim == 1 and stamps.size
    if dated and all(isinstance(at, datetime) for at in stamps):
        return _since_the_first(list(stamps), where), ()
    written = isinstance(stamps, np.ndarray) and stamps.dtype.kind in "OU" and stamps.ndim == 1 and stamps.size
    if written and all(isinstance(at, str) for at in stamps):
        return _of_text(stamps, where)
    return numbers(stamps, where), ()


def _of_text(stamps: NDArray, where: str) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """Seconds of dates and times as text, read like those of a file: pandas.read_csv leaves them as they are."""
    reads, found = TimeStamps(text.strip() for text in stamps), np.empty((2, len(stamps)))
    for k, text in enumerate(stamps):
        try:
            found[:, k] = reads.minute_and_seconds(text.strip())
        except ValueError as error:
            raise UserError(f"{where}, sample {k} (the first is 0): found {str(text)!r:.40}: {error}") from None
    return (found - found[:, :1]).sum(axis=0), (f"time: {reads.note}",) if reads.note else ()


def _since_the_first(stamps: Sequence[datetime], where: str) -> NDArray[np.float64]:
    """Seconds of dates and times, for with a time zone NumPy knows none. pandas.NaT, which equals nothing, is a missing one."""
    aware = [at.utcoffset() is not None if at == at else None for at in stamps]
    if True in aware and False in aware:
        k = aware.index(not next(one for one in aware if one is not None))
        found = "with a time zone" if aware[k] else "without a time zone"
        raise UserError(
            f"{where}, sample {k} (the first is 0): found {stamps[k]} {found}, unlike those before it; "
            "expected a time zone in all time stamps, or in none"
        )
    if True in aware:  # two of one zone are subtracted by the clock on the wall, which jumps in spring and autumn
        stamps = [at.astimezone(UTC) if at == at else at for at in stamps]
    return np.array([(at - stamps[0]).total_seconds() for at in stamps])


def _common_length(place: str, arrays: Mapping[str, NDArray]) -> int:
    lengths = {name: len(values) for name, values in arrays.items()}
    if len(set(lengths.values())) > 1:
        found = ", ".join(f'"{name}" has {length}' for name, length in lengths.items())
        raise UserError(f"{place}, signals: arrays differ in length: {found}; expected as many samples in each")
    return next(iter(lengths.values()))


def _units(place: str, units: Mapping[str, str] | None, channels: Mapping[str, Any]) -> dict[str, str]:
    for channel, unit in (units or {}).items():
        if channel not in channels:
            hint = did_you_mean(str(channel), channels)
            raise UserError(f"{place}, units: no channel {channel!r}{hint}; expected {', '.join(channels)}")
        if not isinstance(unit, str):
            raise UserError(f'{place}, units: found {_shown(unit)} for "{channel}", expected text such as "rad/s"')
    return dict(units or {})


def _column_names(place: str, frame: Any) -> Sequence[Any]:
    """The names of a table's columns, as its library gives them."""
    dtype = getattr(frame, "dtype", None)
    for names in (
        getattr(frame, "column_names", None),  # pyarrow
        getattr(getattr(frame, "schema", None), "names", None) if not hasattr(frame, "columns") else None,
        getattr(frame, "columns", None),  # pandas, polars
        getattr(dtype, "names", None),  # structured arrays of NumPy
        list(frame) if isinstance(frame, Mapping) else None,
    ):
        if names is not None and not callable(names):
            return list(names)
    raise UserError(
        f"{place}, frame: found {_shown(frame)}, expected a table with columns: a DataFrame, a pyarrow Table, a dictionary of arrays"
    )


def _values(frame: Any, column: Any) -> Any:
    return frame[column]


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"an object of type {type(value).__name__}"
