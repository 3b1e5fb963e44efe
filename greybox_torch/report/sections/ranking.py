"""What else was considered: the hypotheses of the screen, ranked."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from greybox_torch.diagnosis.one_of import spoken_at
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.name_lists import listed
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
    """``left_out`` counts hypotheses that explain less than all that are shown; ``passed_over`` says why one that removed more than what
    was chosen was not, "" where none did.
    """

    rows: tuple[Row, ...]
    left_out: int
    mismatch: bool
    passed_over: str = ""
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
        return cls(tuple(rows), len(verdict.ranking) - len(rows), bool(verdict.effects), _passed_over(shown, chosen))


def _passed_over(shown: Sequence[tuple[str, str, float, float | None]], chosen: set[tuple[str, str]]) -> str:
    """Which rows removed visibly more than the best of the ``chosen`` ones, and by what rule these stand before them."""
    refitted = {(port, mechanism): gain for port, mechanism, _, gain in shown if gain is not None}
    best = max(chosen & refitted.keys(), key=lambda row: refitted[row], default=None)
    if best is None:
        return ""
    least = refitted[best]
    others = {row: gain for row, gain in refitted.items() if row not in chosen and gain > least}
    more = [row for row, gain in others.items() if _removed(gain, False) != _removed(least, False)]
    containing = [row for row in more if _contains(row, best)]
    rest = [row for row in more if row not in containing]
    said = []
    if containing:
        it = "it contains" if len(containing) == 1 else "they contain"
        said.append(
            f"{_names(containing)} removed more than {spoken_at(best[1], best[0])}, which {it}: the simpler law is chosen unless the other "
            "one is better by more than chance, and by as much as a finding has to be."
        )
    if rest:
        than = "as well" if containing else f"than {spoken_at(best[1], best[0])}"
        said.append(
            f"{_names(rest)} removed more {than}: it is not the error alone that decides, but also the number of parameters, held-out "
            "experiments, and whether it is a law or a free curve."
        )
    return " ".join(map(text.first_capital, said))


def _contains(row: tuple[str, str], other: tuple[str, str]) -> bool:
    law = LIBRARY.get(row[1])
    return row[0] == other[0] and law is not None and other[1] in law.generalises


def _names(rows: Sequence[tuple[str, str]]) -> str:
    return listed([spoken_at(mechanism, port) for port, mechanism in rows])


def _removed(gain: float | None, chosen: bool) -> str:
    """What the refit of the first step removed; of two effects one is chosen later, beside the other."""
    if gain is not None:
        return text.percent(-math.expm1(-gain))
    return "refitted later, beside others" if chosen else "not refitted"
