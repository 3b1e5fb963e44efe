"""What the machines of a fleet have in common, parameter by parameter, and which of them stand out."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from greybox_torch.fleets.random_effects import FEWEST, Common, common
from greybox_torch.fleets.row import Row
from greybox_torch.report import text


@dataclass(frozen=True, eq=False)
class Group:
    """Machines of one model that show one effect, by the effect's key ``parameter`` (full name), in ``unit``; ``of`` machines have the
    model.
    """

    model: str
    parameter: str
    unit: str
    rows: tuple[Row, ...]
    of: int
    estimate: Common

    @property
    def effect(self) -> str:
        """In words, such as `Coulomb friction at rotor`."""
        port, mechanism, _ = self.parameter.split(".", 2)
        return f"{text.mechanism(mechanism)} at {text.words(port)}"

    @property
    def name(self) -> str:
        """The parameter in words, such as `Coulomb friction at rotor: F_c`."""
        return f"{self.effect}: {self.parameter.rpartition('.')[2]}"

    @property
    def outliers(self) -> tuple[tuple[Row, float, float], ...]:
        """Each with its shrunken value and its residual in standard deviations, the farthest first."""
        found = zip(self.rows, self.estimate.shrunken, self.estimate.residuals, self.estimate.outlying, strict=True)
        far = [(row, float(value), float(residual)) for row, value, residual, outlying in found if outlying]
        return tuple(sorted(far, key=lambda entry: -abs(entry[2])))

    def as_json(self) -> dict[str, Any]:
        return {
            "model": self.model,
            "parameter": self.parameter,
            "unit": self.unit,
            "machines": len(self.rows),
            "of": self.of,
            "mean": self.estimate.mean,
            "std": self.estimate.std,
            "between": self.estimate.between,
            "shrunken": {row.machine: float(v) for row, v in zip(self.rows, self.estimate.shrunken, strict=True)},
            "outliers": [
                {"machine": row.machine, "value": row.value, "std": row.std, "shrunken": value, "residual": residual}
                for row, value, residual in self.outliers
            ],
        }


def groups(rows: Iterable[Row]) -> tuple[Group, ...]:
    """Of every effect that enough machines show with a deviation, the most frequent first. Of each machine its latest recording counts."""
    last = latest(row for row in rows if row.answer not in ("failed", "unfinished"))
    together: dict[tuple[str, str, str], list[Row]] = {}
    for row in last:
        if row.key_parameter and row.value is not None and row.std is not None and math.isfinite(row.value * row.std):
            together.setdefault((row.model, row.key_parameter, row.unit), []).append(row)
    found = [
        Group(*key, tuple(own), sum(row.model == key[0] for row in last), _estimate(own))
        for key, own in together.items()
        if len(own) >= FEWEST
    ]
    return tuple(sorted(found, key=lambda group: -len(group.rows)))


def latest(rows: Iterable[Row]) -> list[Row]:
    """The row of each machine with the last date; the last one where there are no dates."""
    by_machine: dict[str, Row] = {}
    for row in rows:
        before = by_machine.get(row.machine)
        if before is None or row.day >= before.day:
            by_machine[row.machine] = row
    return list(by_machine.values())


def _estimate(rows: list[Row]) -> Common:
    return common(np.array([row.value for row in rows]), np.array([row.std for row in rows]))
