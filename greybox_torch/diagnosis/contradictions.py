"""Where a verdict contradicts itself: what no verdict may do, whatever is true of the machine (contract, section 8)."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

WORSE = 1.001
"""Times the re-estimated model's error from which on a free run counts as worse: what rounding does is not meant."""

BETTER_ELSEWHERE = 4.0
"""Times that the re-estimated model is farther behind where it is behind, from which on the recommended one is not the worse of the two."""

NEGLIGIBLE = 1e-5
"""Share of an output's spread below which its errors are alike: interpolation and rounding decide there."""

Rows = Sequence[Mapping[str, Any]]


def worse_than_refit(fit: Rows, unstable: Collection[str] = ()) -> bool:
    """Whether the recommended model simulates the validation experiments worse than the re-estimated one.

    By the root mean square over experiments and outputs, each in units of the re-estimated model's error. That alone would ask every
    experiment, also one of small motion, in which the re-estimated model leaves no more than noise: where its errors in units of the
    recommended model's are ``BETTER_ELSEWHERE`` times as large as those the other way round, it is the worse of the two. A free run that
    overflows has no number (null in JSON): it is worse than any that has one. Where that of the re-estimated model overflows, there is
    nothing to be worse than.

    Args:
        fit: the rows ``fit`` of a verdict.
        unstable: experiments that no free run follows, which do not count.
    """
    spreads = _spreads(fit)
    ratios = []
    for row in fit:
        if row["role"] == "validation" and row.get("experiment") not in unstable:
            before, after = (_finite(row[stage]["rmse"]) for stage in ("refit", "augmented"))
            if before is None:
                continue
            if after is None:
                return True
            least = max(NEGLIGIBLE * spreads.get(row.get("output"), 0.0), 1e-300)
            ratios.append(max(after, least) / max(before, least))
    behind, ahead = (math.hypot(*r) for r in (ratios, [1.0 / r for r in ratios]))
    return behind > WORSE * math.sqrt(len(ratios)) and ahead < BETTER_ELSEWHERE * behind


def contradictions(verdict: Mapping[str, Any]) -> list[str]:
    """Sentences, one for each; empty where there is none.

    Args:
        verdict: the content of `verdict.json`; numbers that are not finite may stand for null.
    """
    found = [*_of_the_whole(verdict)]
    second_edition = str(verdict.get("schema", "")).endswith("/2")
    for effect in verdict["effects"]:
        found += [
            f"{effect['mechanism']} at {effect['port']}: {what}" for what in _of_an_effect(effect, second_edition)
        ]
    return found


def _of_the_whole(verdict: Mapping[str, Any]) -> Iterator[str]:
    if verdict["effects"] and not verdict["mismatch"]:
        yield "effects are named, and nothing is said to be missing"
    if verdict["effects"] and worse_than_refit(verdict["fit"], verdict.get("unstable", ())):
        yield "the recommended model simulates the validation experiments worse than the re-estimated one"
    judging = {row.get("experiment") for row in verdict["fit"] if row["role"] == "validation"}
    if 2 * len(set(verdict.get("unstable", ())) - _lost(verdict["fit"])) > len(judging):
        yield "more than half of the validation experiments do not count"
    if not verdict["effects"] and any(_differ(row) for row in verdict["fit"]):
        yield "nothing is named, and the recommended model is not the re-estimated one"
    confidence = verdict.get("confidence", 0.5)
    if not 0.0 <= confidence <= 1.0:
        yield f"its confidence is {confidence}"
    names = [(e["port"], e["mechanism"]) for e in verdict["effects"]]
    for port, mechanism in sorted({name for name in names if names.count(name) > 1}):
        yield f"{mechanism} at {port} is named twice"


def _of_an_effect(effect: Mapping[str, Any], sized: bool) -> Iterator[str]:
    """`sized`: effects of the second edition state their size."""
    probability = _finite(effect["probability"])
    if probability is None or not 0.0 <= probability <= 1.0:
        yield f"its probability is {probability}"
    if sized and not (_finite(effect.get("size")) or 0.0) > 0.0:
        yield f"its size is {effect.get('size')}"
    whole = effect.get("one_of")
    if whole and whole["probability"] < (probability or 0.0) - 1e-9:
        yield f"it is likelier ({probability:.2f}) than the class that it belongs to ({whole['probability']:.2f})"
    for name, value in effect.get("parameters", {}).items():
        if _finite(value["value"]) is None:
            yield f"{name} has no value"


def _lost(fit: Rows) -> set[str | None]:
    """Experiments of which the free runs of the re-estimated model and of the recommended one overflow or are worse than a constant."""
    kept = {row.get("experiment") for row in fit if not all(_is_lost(row[stage]) for stage in ("refit", "augmented"))}
    return {row.get("experiment") for row in fit} - kept


def _is_lost(score: Mapping[str, Any]) -> bool:
    share = _finite(score.get("fit"))
    return _finite(score["rmse"]) is None or (share is not None and share < 0.0)


def _differ(row: Mapping[str, Any]) -> bool:
    return _finite(row["augmented"]["rmse"]) != _finite(row["refit"]["rmse"])


def _spreads(fit: Rows) -> dict[str | None, float]:
    """How far every output moves, root mean square about its mean: the largest over experiments.

    An output's fit in % is its error in units of that.
    """
    largest: dict[str | None, float] = {}
    for row in fit:
        for score in (row["start"], row["refit"]) if "start" in row else (row["refit"],):
            error, share = _finite(score["rmse"]), _finite(score.get("fit"))
            if error is not None and share is not None and share < 100.0:
                output = row.get("output")
                largest[output] = max(largest.get(output, 0.0), error / (1.0 - share / 100.0))
    return largest


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None
