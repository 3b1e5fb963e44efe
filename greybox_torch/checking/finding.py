"""One thing that is wrong with a model: where, what was found, and what to write instead."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

Level = Literal["error", "warning", "note"]
LEVELS: tuple[Level, ...] = ("error", "warning", "note")

Topic = Literal["declaration", "name", "code", "units", "influence", "numbers", "card"]


@dataclass(frozen=True)
class Finding:
    """A model, or a card, with an ``error`` cannot be used; a ``warning`` makes results slow or doubtful; a ``note`` may be meant as it is.

    ``found`` says what is there, ``write`` what to write instead. ``line`` is None where no line of ``file`` can be named.
    """

    level: Level
    topic: Topic
    found: str
    write: str
    file: Path | None = None
    line: int | None = None

    @property
    def place(self) -> str:
        """`my_motor.py, line 12: `, as far as it is known."""
        if self.file is None:
            return ""
        return f"{self.file.name}, line {self.line}: " if self.line else f"{self.file.name}: "

    def __str__(self) -> str:
        return f"{self.place}{self.found}; write: {self.write}"


def in_order(findings: list[Finding]) -> tuple[Finding, ...]:
    """Errors first, then by line; none twice."""
    once = list(dict.fromkeys(findings))
    return tuple(sorted(once, key=lambda f: (LEVELS.index(f.level), f.line or 0)))
