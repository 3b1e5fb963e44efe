"""The cases scored, as a table of all and totals by kind of case."""

from __future__ import annotations

import statistics
from collections.abc import Iterator, Sequence

import numpy as np

from experiments.verdicts.answers import half_brier
from experiments.verdicts.calibrate import CLASSES, EXACT, NAMES, brier, claims_of
from experiments.verdicts.scoring import KINDS, OUTSIDE, Finding, Scored


def table(scored: Sequence[Scored]) -> str:
    """Markdown: every case with misses beside hits, the totals by kind, and the lines of `closing`."""
    lines = [
        "| case | concealed | said | detected | located | named | spurious | closed |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for s in scored:
        count = len(s.effects)
        shares = (f"{s.located}/{count}", f"{s.named}/{count}") if count else ("", "")
        closed = "" if s.closed is None else f"{s.closed:.2f}"
        cells = (
            s.name,
            ", ".join(s.effects) or "nothing",
            s.said,
            "yes" if s.detected else "no",
            *shares,
            s.spurious,
            closed,
        )
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    lines += [
        "",
        "| kind | cases | detected | located | named | spurious | median closed |",
        "|---|---|---|---|---|---|---|",
    ]
    for kind in (*KINDS, OUTSIDE):
        own = [s for s in scored if s.kind == kind]
        if own:
            lines.append(_totals(kind, own))
    return "\n".join([*lines, _totals("all", scored), "", *closing(scored)])


def closing(scored: Sequence[Scored]) -> Iterator[str]:
    """Brier scores, and what should be zero: verdicts that are missing, that recommend a worse model, that contradict themselves."""
    findings = [f for s in scored for f in s.findings]
    scores = f"{brier_of(findings):.3f}, of answers {brier_of_answers(findings):.3f}, of classes {brier_of_classes(findings):.3f}"
    yield f"Brier {scores}, over {len(findings)} findings"
    for what, cases in (
        ("without a verdict", [f"{s.name} ({s.said})" for s in scored if s.verdict is None]),
        ("validation worse than the re-estimated model's", [s.name for s in scored if s.worse]),
        (
            "that contradict themselves",
            [f"{s.name} ({'; '.join(s.contradictions)})" for s in scored if s.contradictions],
        ),
    ):
        yield f"{what}: {len(cases)}" + (f": {', '.join(cases)}" if cases else "")


def brier_of(findings: Sequence[Finding]) -> float:
    """Mean squared difference between the probability of a finding and whether it is right (Brier, 1950)."""
    return _brier(findings, NAMES)


def brier_of_exact_names(findings: Sequence[Finding]) -> float:
    """The same of the names, each right where it is what was concealed itself."""
    return _brier(findings, EXACT)


def brier_of_classes(findings: Sequence[Finding]) -> float:
    """The same of the classes, each right where any of its members is."""
    return _brier(findings, CLASSES)


def _brier(findings: Sequence[Finding], what: str) -> float:
    told = [claim for f in findings for claim in claims_of(f, what)]
    return brier(np.array([p for p, _ in told]), np.array([float(right) for _, right in told]))


def brier_of_answers(findings: Sequence[Finding]) -> float:
    """The same over all answers of each finding, of which names that the key accepts are one (half of Brier's sum of squares)."""
    return float(np.mean([half_brier(f.answers) for f in findings])) if findings else float("nan")


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
