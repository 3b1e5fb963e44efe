"""Where a verdict contradicts itself: what no verdict may do, whatever is true of the machine."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

WORSE = 1.001
"""Times the re-estimated model's error from which on a free run counts as worse: what rounding does is not meant."""


def worse_than_refit(verdict: Mapping[str, Any]) -> bool:
    """Whether the recommended model simulates the validation experiments worse than the re-estimated one, root mean square over
    experiments and outputs, each in units of the re-estimated model's error.

    A free run that overflows has no number (null in JSON): it is worse than any that has one.
    """
    ratios = []
    for row in verdict["fit"]:
        if row["role"] == "validation":
            before, after = (row[stage]["rmse"] for stage in ("refit", "augmented"))
            if before is None:
                continue  # a plain run that diverges cannot be judged by
            if after is None:
                return True
            ratios.append((after / before) ** 2 if before > 0 else float(after > 0) * math.inf)
    return bool(ratios) and math.sqrt(sum(ratios) / len(ratios)) > WORSE


def contradictions(verdict: Mapping[str, Any]) -> list[str]:
    """Sentences, one for each; empty where there is none."""
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
    if verdict["effects"] and worse_than_refit(verdict):
        yield "the recommended model simulates the validation experiments worse than the re-estimated one"
    names = [(e["port"], e["mechanism"]) for e in verdict["effects"]]
    for port, mechanism in sorted({name for name in names if names.count(name) > 1}):
        yield f"{mechanism} at {port} is named twice"


def _of_an_effect(effect: Mapping[str, Any], sized: bool) -> Iterator[str]:
    """`sized`: effects of the second edition state their size."""
    probability = effect["probability"]
    if not 0.0 <= probability <= 1.0:
        yield f"its probability is {probability}"
    if sized and not effect.get("size", 0.0) > 0.0:
        yield f"its size is {effect.get('size')}"
    whole = effect.get("one_of")
    if whole and whole["probability"] < probability - 1e-9:
        yield f"it is likelier ({probability:.2f}) than the class that it belongs to ({whole['probability']:.2f})"
    for name, value in effect.get("parameters", {}).items():
        if value["value"] is None:
            yield f"{name} has no value"
