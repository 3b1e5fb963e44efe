"""What is in the files that a card is to be written for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.columns import columns_of
from greybox_torch.data.readers import read_table
from greybox_torch.data.readers.table import Table
from greybox_torch.errors import UserError


@dataclass(frozen=True, eq=False)
class Recorded:
    """A file: columns (N,) of numbers by name, units by column where the file says them, single numbers by name.

    ``left_out`` are columns that hold another number of samples than most, ``faults`` those that hold something else than numbers,
    with what was found and where. ``stamps`` are columns of dates or times of day. ``lines`` has the line of every
    sample, where there are lines.
    """

    path: Path
    columns: dict[str, NDArray[np.float64]]
    units: Mapping[str, str]
    numbers: Mapping[str, float]
    left_out: tuple[str, ...] = ()
    faults: Mapping[str, str] = field(default_factory=dict)
    stamps: frozenset[str] = frozenset()
    lines: Sequence[int] | None = None

    @property
    def samples(self) -> int:
        return len(next(iter(self.columns.values())))

    def where(self, sample: int) -> str:
        """Where a sample stands in the file."""
        return f"sample {sample} (the first is 0)" if self.lines is None else f"line {self.lines[sample]}"


def recorded(path: Path) -> Recorded:
    """All that can be read of a file. Raises UserError as the readers do, and where no column holds numbers."""
    listing = columns_of(path)
    table, faults = _read(path, listing.names)
    lengths = [len(values) for values in table.columns.values()]
    if not lengths and listing.names:
        read_table(path, listing.names[:1])  # says what is wrong with it
    if not lengths:
        raise UserError(f"{path}: found no column of numbers that could be read; expected a recording")
    usual = max(set(lengths), key=lambda n: (lengths.count(n), n))
    kept = {name: values for name, values in table.columns.items() if len(values) == usual}
    other = tuple(name for name in table.columns if name not in kept)
    return Recorded(path, kept, table.units, listing.numbers, other, faults, table.stamps, table.lines)


def _read(path: Path, names: Sequence[str]) -> tuple[Table, dict[str, str]]:
    """All columns at once, or where one of them cannot be read, each that can, and what is wrong with the others."""
    if not names:
        return Table(path, {}), {}
    try:
        return read_table(path, names), {}
    except UserError:
        pass
    columns: dict[str, NDArray[np.float64]] = {}
    units: dict[str, str] = {}
    stamps: frozenset[str] = frozenset()
    lines, faults = None, {}
    for name in names:
        try:
            one = read_table(path, (name,))
        except UserError as error:
            faults[name] = str(error).removeprefix(f"{path}, ").replace(f', column "{name}"', "")
            continue
        columns |= one.columns
        units |= one.units
        stamps |= one.stamps
        lines = one.lines
    return Table(path, columns, lines, units, stamps=stamps), faults
