"""The checks that samples get, whether they come from a file or from memory. A caller says in its own words where a sample stands."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.summer_time import clock_set_back, instead_of_summer_time
from greybox_torch.errors import UserError

FEWEST_SAMPLES = 10
LARGEST = 1e100
"""Largest sample: squares and sums of squares of larger ones are no numbers any more."""

DAY = 86400.0
"""Seconds of a day."""

KINDS = {"U": "text", "S": "text", "T": "text", "c": "complex numbers", "O": "cells or objects", "V": "a structure"}
"""What an array holds, by the kind of its dtype, in words for messages."""

Place = Callable[[int], str]
"""Where sample k stands: the beginning of a message about it."""


class NotANumber(UserError):
    """A column holds what is no number."""


def check_finite(values: NDArray[np.float64], place: Place) -> None:
    """Raises UserError where one of the values (N,) is infinite, or so large that its square is no number. NaN is a missing sample."""
    wrong = np.flatnonzero(np.abs(values) > LARGEST)
    if wrong.size:
        found = values[wrong[0]]
        expected = "a finite number" if np.isinf(found) else f"a number of at most {LARGEST:g}, in another unit perhaps"
        raise UserError(
            f"{place(int(wrong[0]))}: found {found:g}, expected {expected} (NaN where the sample is missing)"
        )


def check_time(time: NDArray[np.float64], place: Place) -> None:
    """Raises UserError unless the time stamps (N,), in seconds, are finite numbers that increase."""
    check_finite(time, place)
    missing = np.flatnonzero(np.isnan(time))
    if missing.size:
        raise UserError(f"{place(int(missing[0]))}: the time stamp is missing; expected a number")
    backward = np.flatnonzero(np.diff(time) <= 0)
    if backward.size:
        later = int(backward[0]) + 1
        raise UserError(
            f"{place(later)}: found {time[later]:.14g} s after {time[later - 1]:.14g} s; "
            f"expected time stamps that increase from sample to sample{_begins_anew(time, later)}"
        )


def _begins_anew(time: NDArray[np.float64], later: int) -> str:
    """What to do where a time of day begins anew, or an hour comes again, to end a message; empty elsewhere."""
    before, after = time[later - 1], time[later]
    steps = np.diff(time)
    step = float(np.median(steps))
    if clock_set_back(before, after, step):
        return f", as where local time is set back from summer time: expected {instead_of_summer_time(step)}"
    if not (0.0 <= after < before <= DAY and before - after > DAY / 2 and (steps > 0.0).any()):
        return ""
    return (
        "; the time of day passes midnight here: give stamps with the date (of a column beside it: "
        'time = { column = "…", date = "…" }), or '
        f"sample_time = {np.median(steps[steps > 0.0]):.6g} in the place of time, or two experiments, with the rows before this sample "
        "and from it on"
    )


def check_length(length: int, place: str) -> None:
    """Raises UserError where a recording is too short to say anything."""
    if length < FEWEST_SAMPLES:
        samples = "sample" if length == 1 else "samples"
        raise UserError(f"{place}: has {length} {samples}; expected at least {FEWEST_SAMPLES}")


def numbers(values: Any, place: str) -> NDArray[np.float64]:
    """A sequence of N real numbers as float64 of shape (N,), with NaN for None, masked and null entries; never a view.

    `values` is an array, a list, a tensor, or a column of a table. Raises UserError for any other shape, and for text, complex numbers
    and whatever else is no number.
    """
    found = _as_array(values, place)
    if found.dtype.kind == "O":
        found = _from_objects(found, place)
    if found.dtype.kind not in "fiub":
        raise NotANumber(
            f"{place}: holds {KINDS.get(found.dtype.kind, str(found.dtype))}; expected real numbers (NaN where a sample is missing)"
        )
    if found.ndim != 1:
        raise UserError(f"{place}: has the shape {found.shape}; expected (N,), one number a sample")
    return np.array(found, dtype=np.float64)


def _as_array(values: Any, place: str) -> NDArray:
    if isinstance(values, np.ma.MaskedArray):
        missing, held = np.ma.getmaskarray(values), np.asarray(values.data)
        if held.dtype.kind in "fiubO":
            held = held.astype(object if held.dtype.kind == "O" else np.float64)
            held[missing] = np.nan
        return held
    try:
        return np.asarray(values.detach().cpu() if hasattr(values, "detach") else values)
    except (TypeError, ValueError, RuntimeError, OverflowError) as error:
        raise UserError(f"{place}: cannot be made an array: {error}; expected N real numbers") from None


def _from_objects(values: NDArray, place: str) -> NDArray[np.float64]:
    """Numbers among which some are missing, as tables give them: None, or a marker of the table's own such as pandas.NA."""
    found = np.empty(values.shape, dtype=np.float64)
    for index, value in np.ndenumerate(values):
        if value is None or type(value).__name__ in ("NAType", "NaTType"):
            found[index] = np.nan
            continue
        if isinstance(value, str | bytes | complex) or not hasattr(value, "__float__"):
            raise NotANumber(f"{place}, sample {index[0]} (the first is 0): found {value!r:.40}, expected a number")
        try:
            found[index] = float(value)
        except (TypeError, ValueError, OverflowError) as error:
            raise UserError(f"{place}, sample {index[0]} (the first is 0): {error}; expected a number") from None
    return found


def check_same_length(columns: Mapping[str, NDArray[np.float64]], file: Path) -> dict[str, NDArray[np.float64]]:
    """The columns (N,) of a file. Raises UserError where they differ in length."""
    lengths = {column: len(values) for column, values in columns.items()}
    if len(set(lengths.values())) > 1:
        found = ", ".join(f'"{column}" has {length}' for column, length in lengths.items())
        raise UserError(
            f"{file}: columns differ in length: {found}; expected as many samples in each; a slower one has to be in "
            'a file of its own with its time stamps, which join = "time" joins'
        )
    return dict(columns)
