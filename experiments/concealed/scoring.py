"""What a verdict is worth against the key of its case.

    python -m experiments.concealed.scoring CASES VERDICTS           # a table of all cases, and the totals by kind

A key lists, for every concealed effect, the answers (port, mechanism) that are right (``accept``), those that are nearly right
(``near``), and the ports where a finding counts as located (``ports``).
"""

from __future__ import annotations

import json
import statistics
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

KINDS = ("without effect", "one effect", "two effects")


@dataclass(frozen=True)
class Finding:
    """One effect of a verdict: what it said, with which probability, and whether it is right, at the right place, or neither."""

    port: str
    mechanism: str
    probability: float
    right: bool
    located: bool
    spurious: bool


@dataclass(frozen=True)
class Scored:
    """A case: its concealed effects, whether the verdict says rightly that there are any, and its findings.

    ``closed`` is the share of the root mean square validation error above the noise that the effects remove; None where nothing is
    concealed.
    """

    name: str
    effects: tuple[str, ...]
    detected: bool
    findings: tuple[Finding, ...]
    closed: float | None
    seconds: float
    outside: bool = False
    """Whether the effect is none of the library's: the right answer is ``unknown``, at the right place."""

    @property
    def kind(self) -> str:
        return "outside the library" if self.outside else KINDS[len(self.effects)]

    @property
    def named(self) -> int:
        return sum(f.right for f in self.findings)

    @property
    def located(self) -> int:
        return sum(f.located for f in self.findings)

    @property
    def spurious(self) -> int:
        return sum(f.spurious for f in self.findings)


def score(name: str, verdict: Mapping[str, Any], key: Mapping[str, Any]) -> Scored:
    """Score one verdict. Every concealed effect is matched by one finding at most, right ones first."""
    effects = tuple(e for e in key["effects"] if e != "none")
    return Scored(
        name,
        effects,
        verdict["mismatch"] == bool(effects),
        _findings(verdict["effects"], key if effects else {"accept": [], "near": [], "ports": []}),
        _closed(verdict, key) if effects else None,
        float(verdict.get("seconds", float("nan"))),
        any(key.get("outside", ())),
    )


def score_all(cases: Path, verdicts: Path) -> list[Scored]:
    """Every case of a folder that has a verdict."""
    found = []
    for file in sorted(cases.glob("*/key.json")):
        verdict = verdicts / file.parent.name / "verdict.json"
        if verdict.exists():
            found.append(score(file.parent.name, json.loads(verdict.read_text()), json.loads(file.read_text())))
    return found


def _findings(effects: Sequence[Mapping[str, Any]], key: Mapping[str, Any]) -> tuple[Finding, ...]:
    open_effects = set(range(len(key["accept"])))
    places: dict[int, tuple[int, bool]] = {}
    for right, table in ((True, "accept"), (False, "near"), (False, "ports")):
        for k, effect in enumerate(effects):
            if k in places:
                continue
            said = effect["port"] if table == "ports" else [effect["port"], effect["mechanism"]]
            hit = next((i for i in sorted(open_effects) if said in [_plain(a) for a in key[table][i]]), None)
            if hit is not None:
                places[k] = (hit, right)
                open_effects.remove(hit)
    return tuple(
        Finding(
            effect["port"],
            effect["mechanism"],
            float(effect["probability"]),
            right=k in places and places[k][1],
            located=k in places and effect["port"] in key["ports"][places[k][0]],
            spurious=k not in places,
        )
        for k, effect in enumerate(effects)
    )


def _plain(answer: Any) -> Any:
    return answer if isinstance(answer, str) else list(answer)


def _closed(verdict: Mapping[str, Any], key: Mapping[str, Any]) -> float:
    """With several outputs ``sigma`` gives each its own noise, in units of which their errors are added."""
    sigma = key["sigma"]
    left = {"refit": 0.0, "augmented": 0.0}
    for row in verdict["fit"]:
        if row["role"] == "validation":
            floor, unit = (sigma[row["output"]],) * 2 if isinstance(sigma, Mapping) else (sigma, 1.0)
            for stage in left:
                left[stage] += max(float(row[stage]["rmse"]) ** 2 - floor**2, 0.0) / unit**2
    return 1.0 - (left["augmented"] / left["refit"]) ** 0.5 if left["refit"] > 0 else 0.0


def table(scored: Sequence[Scored]) -> str:
    """The cases as a Markdown table, misses beside hits, and the totals by kind of case."""
    lines = ["| case | concealed | said | named | closed |", "|---|---|---|---|---|"]
    for s in scored:
        said = ", ".join(f"{f.mechanism} at {f.port} ({f.probability:.2f})" for f in s.findings) or "nothing missing"
        closed = "" if s.closed is None else f"{s.closed:.2f}"
        right = ("yes" if s.detected else "no") if not s.effects else f"{s.named}/{len(s.effects)}"
        lines.append(f"| {s.name} | {', '.join(s.effects) or 'nothing'} | {said} | {right} | {closed} |")
    lines += [
        "",
        "| kind | cases | detected | located | named | spurious | median closed |",
        "|---|---|---|---|---|---|---|",
    ]
    for kind in (*KINDS, "outside the library"):
        own = [s for s in scored if s.kind == kind]
        if own:
            lines.append(_totals(kind, own))
    return "\n".join([*lines, _totals("all", scored)])


def _totals(kind: str, scored: Sequence[Scored]) -> str:
    effects = sum(len(s.effects) for s in scored)
    closed = [s.closed for s in scored if s.closed is not None]
    cells = (
        kind,
        len(scored),
        f"{sum(s.detected for s in scored)}/{len(scored)}",
        f"{sum(s.located for s in scored)}/{effects}",
        f"{sum(s.named for s in scored)}/{effects}",
        sum(s.spurious for s in scored),
        f"{statistics.median(closed):.2f}" if closed else "",
    )
    return "| " + " | ".join(map(str, cells)) + " |"


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    print(table(score_all(Path(sys.argv[1]), Path(sys.argv[2]))))
