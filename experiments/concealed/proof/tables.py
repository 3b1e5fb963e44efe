"""The tables of the page, in Markdown."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence

from experiments.concealed.proof.plan import EXCITATION, NOISE
from experiments.concealed.proof.promises import Promise
from experiments.concealed.proof.reasons import reasons
from experiments.verdicts.rates import Rate
from experiments.verdicts.scoring import Scored


def mark(promise: Promise) -> str:
    return {True: "kept", False: "NOT KEPT", None: "too few cases"}[promise.kept]


def promise_table(kept: Sequence[Promise]) -> str:
    lines = ["| | wanted | measured (95 % interval) | |", "|---|---|---|---|"]
    return "\n".join([*lines, *(f"| {p.what} | {p.wanted} | {p.measured} | {mark(p)} |" for p in kept)])


def group_table(found: Sequence[Scored], what: str, groups: Sequence[str], of: Callable[[Scored], str]) -> str:
    lines = [
        f"| {what} | cases | detected rightly | located | named | spurious | median closed |",
        "|---|---|---|---|---|---|---|",
    ]
    for group in groups:
        own = [r for r in found if of(r) == group]
        if own:
            lines.append(_totals(group, own))
    return "\n".join([*lines, _totals("all", found)])


def _totals(label: str, own: Sequence[Scored]) -> str:
    effects = sum(len(r.effects) for r in own)
    closed = [r.closed for r in own if r.closed is not None]
    cells = (
        label,
        len(own),
        Rate(sum(r.detected for r in own), len(own)),
        f"{sum(r.located for r in own)}/{effects}" if effects else "",
        f"{sum(r.named for r in own)}/{effects}" if effects else "",
        sum(r.spurious for r in own),
        f"{statistics.median(closed):.2f}" if closed else "",
    )
    return "| " + " | ".join(map(str, cells)) + " |"


def sweeps(found: Sequence[Scored]) -> list[str]:
    """The same effect under each of the four excitations, and under rising noise."""
    parts = []
    for section, heading, what, varied in (
        (
            EXCITATION,
            "## The same effect, chosen with each of the four experiments in turn",
            "estimation experiment",
            "estimation",
        ),
        (NOISE, "## The same effect under rising noise", "noise, times the usual", "noise"),
    ):
        own = sorted((r for r in found if r.key["section"] == section), key=lambda r: (r.key["number"], r.key[varied]))
        if own:
            lines = [f"| machine | concealed | {what} | visibility | said | right |", "|---|---|---|---|---|---|"]
            for r in own:
                cells = (
                    r.key["machine"],
                    _concealed(r),
                    r.key[varied],
                    f"{r.key['visibility']:.1f}",
                    r.said,
                    _yes(r.right),
                )
                lines.append("| " + " | ".join(map(str, cells)) + " |")
            parts += [heading, "\n".join(lines)]
    return parts


def misses(found: Sequence[Scored]) -> str:
    missed = [r for r in found if not r.right]
    if not missed:
        return "Nothing did."
    lines = ["| case | machine | concealed | visibility | said | why |", "|---|---|---|---|---|---|"]
    for r in missed:
        cells = (r.name, r.key["machine"], _concealed(r), _visibility(r), r.said, "; ".join(reasons(r)))
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(lines)


def case_table(found: Sequence[Scored]) -> str:
    lines = [
        "| case | machine | concealed | strength | visibility | said | right | closed | s |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for r in found:
        closed = "" if r.closed is None else f"{r.closed:.2f}"
        cells = (
            r.name,
            r.key["machine"],
            _concealed(r),
            r.strength,
            _visibility(r),
            r.said,
            _yes(r.right),
            closed,
            r.seconds,
        )
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(lines)


def _concealed(row: Scored) -> str:
    return ", ".join(row.effects) or "nothing"


def _visibility(row: Scored) -> str:
    """Of all effects together, and what each of a pair adds beside the other."""
    each = " and ".join(f"{v:.1f}" for v in row.key.get("beside", ()))
    return f"{row.key['visibility']:.1f}{f' ({each})' if each else ''}" if row.effects else ""


def _yes(right: bool) -> str:
    return "yes" if right else "no"
