"""Files whose time stamps have another name in each, at one position: a card names that column by its position."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

from greybox_torch.data.columns import columns_of
from greybox_torch.drafting.clock import Clock
from greybox_torch.drafting.recorded import Recorded
from greybox_torch.name_lists import listed

_Kept = TypeVar("_Kept")


def by_position(files: Sequence[Recorded], clocks: Sequence[Clock]) -> list[tuple[Recorded, Clock]]:
    """The files and their clocks with the column of time stamps called by its position, "#1" for the first, as readers call it.

    Empty where a file has no such column, one of dates beside it, or one at another position or in another unit than the first file's.
    """
    names = [clock.column for clock in clocks]
    if None in names or any(clock.date for clock in clocks) or len({clock.unit for clock in clocks}) > 1:
        return []
    places = {_place(file, str(name)) for file, name in zip(files, names, strict=True)}
    if len(places) > 1 or None in places:
        return []
    (place,) = places
    called = listed([f'"{name}"' for name in dict.fromkeys(names)], "or")
    told = f"column {place} of each file, which is called {called}"
    return [
        (
            _renamed(file, str(clock.column), f"#{place}"),
            replace(clock, column=f"#{place}", position=place, remark=f"{told}; {clock.remark}"),
        )
        for file, clock in zip(files, clocks, strict=True)
    ]


def _place(file: Recorded, column: str) -> int | None:
    """The position of a column, from 1 on, as cards count."""
    names = columns_of(file.path).names
    return names.index(column) + 1 if column in names else None


def _renamed(file: Recorded, column: str, name: str) -> Recorded:
    def of(by_column: Mapping[str, _Kept]) -> dict[str, _Kept]:
        return {name if key == column else key: value for key, value in by_column.items()}

    stamps = frozenset(name if key == column else key for key in file.stamps)
    return replace(file, columns=of(file.columns), units=of(file.units), orders=of(file.orders), stamps=stamps)
