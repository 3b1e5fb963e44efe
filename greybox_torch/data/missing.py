"""Where a sample that is missing in a channel is missing in its file, and which rows leave it out."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.expression import Expression
from greybox_torch.data.gaps import pieces_around
from greybox_torch.data.readers.table import Table
from greybox_torch.data.source import Source


def where_missing(
    source: Source,
    clock: str | None,
    formula: Expression,
    values: NDArray[np.float64],
    rows: tuple[int, int],
    near: int,
) -> str:
    """The file and line of a sample that is missing among a channel's values (N,), those of `rows`, and what to write instead.

    Args:
        near: the sample, or the one after it.
    """
    missing = np.isnan(values)
    sample = near if near < len(missing) and missing[near] else near - 1
    known = np.flatnonzero(~missing)
    before, after = known[known < sample], known[known > sample]
    lost = (before[-1] + 1 if before.size else 0), (after[0] if after.size else len(values))
    column = next((c for c in formula.columns if np.isnan(source.columns[c][rows[0] + sample])), formula.columns[0])
    place = _place(source, clock, column, rows[0] + sample)
    return (
        f"{place}; expected no gap where a derivative is asked for: "
        f"{pieces_around((rows[0] + int(lost[0]), rows[0] + int(lost[1])), rows)}"
    )


def _place(source: Source, clock: str | None, column: str, sample: int) -> str:
    table = source.table(column)
    if clock is None or not any(table is joined for joined in source.joined):
        return f"{source.place(column, sample)} is missing"
    time, stamps = source.columns[clock][sample], table.columns[clock]
    last = int(np.searchsorted(stamps, time, side="right")) - 1
    if not 0 <= last < len(stamps) - 1:
        of = f"sample {sample} (the first is 0) of {source.tables[0].path}"
        return f"{table.path}: its time stamps {'begin after' if last < 0 else 'end before'} {of}"
    return _between(table, column, last)


def _between(table: Table, column: str, last: int) -> str:
    """The sample that is missing there, or the one that a gap begins after."""
    for sample in (last, last + 1):
        if np.isnan(table.columns[column][sample]):
            return f"{table.place(column, sample)} is missing"
    return f"{table.place(column, last)} is followed by a gap"
