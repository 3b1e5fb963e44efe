"""The tool and the other ways on the same cases, with the same scoring: one row a case and method, and the totals."""

from __future__ import annotations

import json
import statistics
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from experiments.verdicts.scoring import Scored, score

TOOL = "greybox diagnose"
METHODS = {
    TOOL: TOOL,
    "sindy": "sparse regression (pysindy), as regressed",
    "sindy_refitted": "sparse regression, everything re-estimated",
    "network": "neural residual",
    "retuned": "plain model, re-tuned",
}
"""In the order of the table."""


@dataclass(frozen=True)
class Row:
    """What one method made of one case: ``can_name`` tells a method that says nothing from one that cannot say anything.

    ``scored`` is None where its numbers failed; ``failed`` then says how.
    """

    case: str
    concealed: tuple[str, ...]
    outside: bool
    method: str
    scored: Scored | None
    can_name: bool = True
    failed: str = ""

    def as_json(self) -> dict[str, Any]:
        s = self.scored
        return {
            "case": self.case,
            "concealed": self.concealed,
            "outside": self.outside,
            "method": self.method,
            "can_name": self.can_name,
            "failed": self.failed,
            "said": [] if s is None else [[f.port, f.mechanism, f.probability] for f in s.findings],
            "named": None if s is None or not self.can_name else s.named,
            "wrong": None if s is None or not self.can_name else len(s.findings) - s.named,
            "closed": None if s is None else s.closed,
            "seconds": None if s is None else s.seconds,
        }


def compared(keys: Path, out: Path, verdicts: Path | None) -> list[Row]:
    """Every case that has a key, with every method that has a result on it; only cases on which all of these methods have one.

    Args:
        keys: folder with NAME/key.json.
        out: folder with NAME/BASELINE.json.
        verdicts: folder with NAME/verdict.json of the tool.
    """
    rows: dict[str, list[Row]] = {}
    for file in sorted(keys.glob("*/key.json")):
        name, key = file.parent.name, json.loads(file.read_text())
        places = {m: out / name / f"{m}.json" for m in METHODS if m != TOOL}
        if verdicts is not None:
            places[TOOL] = verdicts / name / "verdict.json"
        found = {m: json.loads(place.read_text()) for m, place in places.items() if place.exists()}
        if found:
            rows[name] = [_row(name, key, m, found[m]) for m in METHODS if m in found]
    methods = {row.method for row in (row for case in rows.values() for row in case)}
    return [row for case in rows.values() if {r.method for r in case} == methods for row in case]


def _row(name: str, key: Mapping[str, Any], method: str, result: Mapping[str, Any]) -> Row:
    concealed = tuple(e for e in key["effects"] if e != "none")
    outside = any(key.get("outside", ()))
    if result.get("failed"):
        return Row(name, concealed, outside, method, None, failed=result["failed"])
    return Row(name, concealed, outside, method, score(name, result, key), result.get("can_name", True))


def table(rows: Sequence[Row]) -> str:
    """Totals by method for each kind of case, then case by case, as Markdown."""
    kinds: dict[str, Callable[[Row], bool]] = {
        "one effect": lambda r: len(r.concealed) == 1 and not r.outside,
        "two effects": lambda r: len(r.concealed) == 2,
        "outside the library": lambda r: r.outside,
        "all with an effect": lambda r: bool(r.concealed),
    }
    lines = [
        "| cases | method | effects named rightly | names that are wrong | cases said to lack nothing | median closed | "
        "worse than re-tuned | median s |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for kind, belongs in kinds.items():
        for method in METHODS:
            own = [r for r in rows if r.method == method and belongs(r)]
            if own:
                lines.append(f"| {kind} | {METHODS[method]} | {' | '.join(_totals(own))} |")
    silent = [r for r in rows if not r.concealed]
    for method in METHODS:
        own = [r for r in silent if r.method == method and r.scored is not None]
        if own:
            alarms, quiet = _alarms(own) if own[0].can_name else ("cannot name",) * 2
            cells = ("without effect", METHODS[method], "", alarms, quiet, "", "", _seconds(own))
            lines.append(f"| {' | '.join(cells)} |")
    return "\n".join([*lines, "", *_case_by_case(rows), *_failures(rows)]) + "\n"


def _totals(rows: Sequence[Row]) -> tuple[str, ...]:
    scored = [r.scored for r in rows if r.scored is not None]
    effects, cases = sum(len(r.concealed) for r in rows), len(rows)
    closed = [-float("inf") if r.scored is None or r.scored.closed is None else r.scored.closed for r in rows]
    worse = sum(c < 0 for c in closed)
    words: tuple[str, ...] = ("cannot name",) * 3
    if rows[0].can_name:
        named, wrong = sum(s.named for s in scored), sum(len(s.findings) - s.named for s in scored)
        words = (f"{named}/{effects}", str(wrong), f"{sum(not s.detected for s in scored)}/{cases}")
    return (*words, f"{statistics.median(closed):.2f}", f"{worse}/{cases}", _seconds(rows))


def _alarms(rows: Sequence[Row]) -> tuple[str, str]:
    """Of cases without effect: how many were given a name, and how many were said to lack nothing."""
    scored = [r.scored for r in rows if r.scored is not None]
    return str(sum(bool(s.findings) for s in scored)), f"{sum(s.detected for s in scored)}/{len(scored)}"


def _seconds(rows: Sequence[Row]) -> str:
    known = [r.scored.seconds for r in rows if r.scored is not None]
    return f"{statistics.median(known):.0f}" if known else ""


def _case_by_case(rows: Sequence[Row]) -> list[str]:
    methods = [m for m in METHODS if any(r.method == m for r in rows)]
    lines = [
        "| case | concealed | " + " | ".join(METHODS[m] for m in methods) + " |",
        "|---" * (2 + len(methods)) + "|",
    ]
    for case in dict.fromkeys(r.case for r in rows):
        own = {r.method: r for r in rows if r.case == case}
        first = next(iter(own.values()))
        cells = [case, ", ".join(first.concealed) or "nothing", *(_cell(own[m]) for m in methods)]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def _cell(row: Row) -> str:
    """What was said, with right names in bold, and the share closed."""
    if row.scored is None:
        return "failed"
    names = [f"**{f.mechanism}** at {f.port}" if f.right else f"{f.mechanism} at {f.port}" for f in row.scored.findings]
    silent = row.scored.detected != bool(row.concealed)  # right where nothing is concealed, wrong where something is
    unnamed = "nothing missing" if silent else "something missing, without a name"
    words = (", ".join(names) or unnamed) if row.can_name else ""
    closed = "" if row.scored.closed is None else f"{row.scored.closed:.2f}"
    return "; ".join(part for part in (words, closed) if part)


def _failures(rows: Sequence[Row]) -> list[str]:
    lines = [f"- {r.case}, {METHODS[r.method]}: {r.failed}" for r in rows if r.failed]
    return ["", "Failed:", "", *lines] if lines else []
