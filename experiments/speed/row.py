"""One row of the comparison: who took how long, how they agree, and whether the target is met."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from typing import Any, Literal


@dataclass(frozen=True)
class Entry:
    """One rival: its time in s (None: not measured), its compile time in s where it compiles (not in the other), and remarks."""

    name: str
    seconds: float | None
    compile_seconds: float | None = None
    ours: bool = False
    note: str = ""


@dataclass(frozen=True)
class Target:
    """What is asked: ``measured`` must be at least (or at most) ``limit``. NaN is a miss; None says that it could not be measured.

    ``condition`` is what must hold besides, such as agreement of the results, or the sentence that says how it does not.
    """

    text: str
    relation: Literal["at least", "at most"]
    limit: float
    measured: float | None
    unit: str = "×"
    failed_condition: str = ""

    @property
    def met(self) -> bool | None:
        if self.measured is None:
            return None
        if math.isnan(self.measured) or self.failed_condition:
            return False
        return self.measured >= self.limit if self.relation == "at least" else self.measured <= self.limit

    @property
    def verdict(self) -> str:
        word = {True: "met", False: "missed", None: "not measured"}[self.met]
        return f"{word} ({self.failed_condition})" if self.failed_condition else word


@dataclass(frozen=True)
class Row:
    """``agreement`` says how the results of the rivals were compared and how near they are; ``curves`` are points (x, seconds) by
    name, for the plot; ``details`` are kept beside the table; ``skipped`` says why there is nothing else.
    """

    key: str
    title: str
    entries: tuple[Entry, ...] = ()
    targets: tuple[Target, ...] = ()
    agreement: str = ""
    notes: tuple[str, ...] = ()
    curves: dict[str, list[tuple[float, float]]] = field(default_factory=dict)
    details: dict[str, Any] = field(default_factory=dict)
    skipped: str = ""

    def as_json(self) -> dict[str, Any]:
        result = asdict(self)
        for target, own in zip(result["targets"], self.targets, strict=True):
            target["met"] = own.met
        return result


def skipped(key: str, title: str, reason: str) -> Row:
    """A row that was not measured, and why."""
    return Row(key, title, skipped=reason)


def apart(one: Any, other: Any) -> float:
    """Largest difference of two arrays of one shape, as a share of the largest value of the second."""
    import numpy as np

    return float(np.max(np.abs(np.asarray(one) - np.asarray(other))) / np.max(np.abs(np.asarray(other))))
