"""What files that are joined in time have in common: next to nothing, where one is read in a wrong unit or from another zero."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import get_args

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.card_channels import ExperimentEntry, FileClock, TimeEntry, TimeUnit
from greybox_torch.data.checks import DAY
from greybox_torch.data.clocks_written import in_clocks
from greybox_torch.data.readers.table import Table
from greybox_torch.data.source import Source
from greybox_torch.errors import UserError

_HARDLY = 0.1
"""Share of the time of both files that they have in common, below which another unit is thought of."""
_MOSTLY = 0.5
"""Share that they would have in another unit, if that is meant."""

Span = tuple[float, float]


def check_common_time(
    place: str, experiment: ExperimentEntry, time: TimeEntry | None, source: Source, rows: tuple[int, int]
) -> None:
    """Raises UserError, beginning with ``place``, where a file that is joined in time has no sample in common with the first one, or where
    the two have next to nothing in common as they are read, and most of their time if one was in another unit.

    Args:
        time: the experiment's; its unit is that of the ``source``.
        rows: of the first file.
    """
    if time is None or not source.joined:
        return
    first, names = source.tables[0], experiment.file
    whole = first.columns[time.column]
    for name, other in zip(names[1:], source.joined, strict=True):
        stamps, own = whole[slice(*rows)], other.columns[time.column]
        if len(stamps) < 2 or len(own) < 2:
            continue
        if not ((whole >= own[0]) & (whole <= own[-1])).any():
            apart = whole[-1] < own[0] or whole[0] > own[-1]
            found = "they have no time in common" if apart else f"no sample of {first.path.name} lies within"
            shift = float(whole[0] - own[0]) * time.seconds
            expected = _begin_together(names[0], name, experiment.clocks.get(name), shift) if apart else _MOST_FIRST
        else:
            found, expected = "they have hardly any time in common", ""
        if _shared(_ends(stamps), _ends(own)) < _HARDLY:
            expected = _in_another_unit(experiment, (names[0], name), (_ends(whole), _ends(own)), time) or expected
        if expected:
            spans = f"{_span(other, own, time)}, and {first.path.name} {_span(first, whole, time)}"
            column = experiment.clocks.get(name, FileClock()).column or time.column
            raise UserError(f'{place}: {other.path}, column "{column}": {spans}: {found}; expected {expected}')


_MOST_FIRST = 'files of one run, first the one with the most samples in their common time, for join = "time"'


def _begin_together(first: str, name: str, clock: FileClock | None, shift: float) -> str:
    """What to write where nothing is in common, with the seconds that a file is to be shifted by."""
    given = {} if clock is None else clock.model_dump(exclude_none=True)
    write = in_clocks(name, **given | {"offset": given.get("offset", 0.0) + shift})
    return (
        'files of one run for join = "time"; or, where their clocks begin at different zeros, the seconds to add: '
        f"{write} lets {name} begin with {first}"
    )


def _in_another_unit(
    experiment: ExperimentEntry, names: tuple[str, str], spans: tuple[Span, Span], time: TimeEntry
) -> str:
    """What to write where the files have most of their time in common if one was in another unit; "" where they have more than hardly any
    as they are read, or the card gives the unit, or another zero, of one of them.
    """
    clocks = [experiment.clocks.get(name, FileClock()) for name in names]
    if _shared(*spans) >= _HARDLY or any(clock.unit or clock.offset for clock in clocks):
        return ""
    for k in (1, 0):
        shares = {}
        for unit in get_args(TimeUnit):
            factor = TimeEntry(column=time.column, unit=unit).seconds / time.seconds
            shares[unit] = _shared((spans[k][0] * factor, spans[k][1] * factor), spans[1 - k])
        best = max(shares, key=lambda unit: shares[unit])
        if shares[best] >= _MOSTLY:
            column = clocks[k].column
            return (
                f"{in_clocks(names[k], column=column, unit=best)}, with which they have {100 * shares[best]:.0f} % of their time in "
                f"common; or, if {names[k]} is in {time.unit}, {in_clocks(names[k], column=column, unit=time.unit)}"
            )
    return ""


def _ends(stamps: NDArray[np.float64]) -> Span:
    return float(stamps[0]), float(stamps[-1])


def _shared(one: Span, other: Span) -> float:
    """Which share of the time of both they have in common."""
    both = min(one[1], other[1]) - max(one[0], other[0])
    return max(both, 0.0) / (max(one[1], other[1]) - min(one[0], other[0]))


def _span(table: Table, stamps: NDArray[np.float64], time: TimeEntry) -> str:
    """From when to when a file goes, as dates where it has dates."""
    ends = stamps[[0, -1]]
    if time.column in table.stamps and ends[0] * time.seconds >= DAY:
        begin, end = (f"{datetime.fromtimestamp(float(s) * time.seconds, UTC):%Y-%m-%d %H:%M:%S}" for s in ends)
        return f"is from {begin} to {end}"
    return f"is from {ends[0]:.10g} to {ends[1]:.10g}"
