"""What else was considered: the hypotheses of the screen, ranked."""

from __future__ import annotations

import math
from dataclasses import dataclass

from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.report import text

MOST_ROWS = 12


@dataclass(frozen=True)
class Row:
    """A hypothesis: what it explains in the screen; ``length`` of its bar in %; ``removed`` by its refit."""

    mechanism: str
    port: str
    explained: str
    length: float
    removed: str
    chosen: bool


@dataclass(frozen=True)
class Ranking:
    """``left_out`` counts hypotheses that explain less than all that are shown."""

    rows: tuple[Row, ...]
    left_out: int
    mismatch: bool
    template: str = "ranking.html.j2"

    @classmethod
    def of(cls, verdict: Verdict) -> Ranking | None:
        if not verdict.ranking:
            return None
        chosen = {(e.port, e.mechanism) for e in verdict.effects}
        shown = [row for k, row in enumerate(verdict.ranking) if k < MOST_ROWS or (row[0], row[1]) in chosen]
        rows = [
            Row(
                text.mechanism(mechanism),
                port,
                text.percent(explained),
                100.0 * min(max(explained, 0.0), 1.0),
                _removed(gain, (port, mechanism) in chosen),
                (port, mechanism) in chosen,
            )
            for port, mechanism, explained, gain in shown
        ]
        return cls(tuple(rows), len(verdict.ranking) - len(rows), bool(verdict.effects))


def _removed(gain: float | None, chosen: bool) -> str:
    """What the refit of the first step removed; of two effects one is chosen later, beside the other."""
    if gain is not None:
        return text.percent(-math.expm1(-gain))
    return "refitted later, beside others" if chosen else "not refitted"
