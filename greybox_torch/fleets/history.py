"""One machine over the dates of its recordings: the effect that it has, its parameters, and when they changed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from greybox_torch.fleets.change_points import FEWEST, LEVEL, ChangePoint, change_points
from greybox_torch.fleets.row import Row

PRESENCE = LEVEL / 2.0
"""What of the level is spent on whether the effect is there; the parameters share the rest."""


@dataclass(frozen=True, eq=False)
class Series:
    """Something about a machine over its recordings.

    ``name`` is a parameter's full name, or the effect's where ``presence`` says whether it is there (values 0 and 1). ``days`` (n,) since
    1970-01-01, ``dates`` (n,) as the cards give them, ``values`` (n,) and ``deviations`` (n,), NaN where not known, in ``unit``.
    """

    name: str
    unit: str
    dates: tuple[str, ...]
    days: NDArray[np.float64]
    values: NDArray[np.float64]
    deviations: NDArray[np.float64]
    changes: tuple[ChangePoint, ...]
    presence: bool = False
    key: bool = False
    """Whether it is the parameter that the machine's row in the table shows."""

    def as_json(self) -> list[dict[str, Any]]:
        """Its changes: what changed, when, from what to what."""
        return [
            {
                "what": f"presence of {self.name}" if self.presence else self.name,
                "date": self.dates[change.index],
                "last_before": self.dates[change.index - 1],
                "before": change.before,
                "after": change.after,
                "unit": self.unit,
                "p": change.p,
            }
            for change in self.changes
        ]


@dataclass(frozen=True, eq=False)
class History:
    """A machine with several dated recordings, as ``rows`` in the order of time."""

    machine: str
    rows: tuple[Row, ...]
    series: tuple[Series, ...]

    @property
    def tested(self) -> bool:
        """Whether there are enough recordings to tell a change from chance."""
        return len(self.rows) >= FEWEST

    @property
    def changed(self) -> bool:
        return any(series.changes for series in self.series)

    def as_json(self) -> list[dict[str, Any]]:
        return [{"machine": self.machine, **change} for series in self.series for change in series.as_json()]


def histories(rows: Iterable[Row]) -> tuple[History, ...]:
    """Of every machine that several dated recordings with an answer are of; those that changed first, then by name."""
    by_machine: dict[str, list[Row]] = {}
    for row in rows:
        if row.recorded and row.answer not in ("failed", "unfinished"):
            by_machine.setdefault(row.machine, []).append(row)
    found = [
        _history(machine, sorted(own, key=lambda row: row.day)) for machine, own in by_machine.items() if len(own) > 1
    ]
    return tuple(sorted(found, key=lambda history: (not history.changed, history.machine)))


def _history(machine: str, rows: Sequence[Row]) -> History:
    return History(machine, tuple(rows), tuple(_all_series(rows)))


def _all_series(rows: Sequence[Row]) -> Iterator[Series]:
    """Whether the effect is there, its key parameter where it is, and the parameters that are estimated in every recording."""
    keys = Counter(row.key_parameter for row in rows if row.key_parameter)
    key = keys.most_common(1)[0][0] if keys else ""
    effect = key.rpartition(".")[0]
    there = np.array([_has(row, effect) for row in rows])
    if effect:
        yield _series(rows, effect, "", there.astype(float), None, PRESENCE, presence=True)
    always = [name for name in rows[0].parameters if all(name in row.parameters for row in rows) and name != key]
    names, level = [*([key] if key else []), *always], LEVEL - PRESENCE
    for name in names:
        own = [row for row in rows if name in row.parameters]
        entries = [row.parameters[name] for row in own]
        values, deviations = (_numbers(entries, field) for field in ("value", "std"))
        unit = str(entries[0].get("unit", ""))
        yield _series(own, name, unit, values, deviations, level / len(names), key=name == key)


def _has(row: Row, effect: str) -> bool:
    return any(name.startswith(f"{effect}.") for name in row.parameters)


def _series(
    rows: Sequence[Row],
    name: str,
    unit: str,
    values: NDArray[np.float64],
    deviations: NDArray[np.float64] | None,
    level: float,
    *,
    presence: bool = False,
    key: bool = False,
) -> Series:
    days = np.array([row.day for row in rows])
    dates = tuple(str(row.recorded) for row in rows)
    changes = change_points(values, level=level, binary=presence) if np.isfinite(values).all() else ()
    spread = np.full(len(values), np.nan) if deviations is None else deviations
    return Series(name, unit, dates, days, values, spread, changes, presence, key)


def _numbers(entries: Sequence[Any], field: str) -> NDArray[np.float64]:
    return np.array([np.nan if entry.get(field) is None else float(entry[field]) for entry in entries])
