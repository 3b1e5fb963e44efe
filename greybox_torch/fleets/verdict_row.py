"""The row of a data set that came to a verdict."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.one_of import spoken_at
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.estimate.comparison import Score, held_out_scores, mean_fit, of_moving_outputs
from greybox_torch.fleets.row import Row
from greybox_torch.mechanisms.library import LEARNED


def row_of_verdict(verdict: Verdict, parameters: Mapping[str, Mapping[str, Any]], row: Row) -> Row:
    """``row``, which says what was recorded, with what the verdict says.

    Args:
        parameters: all that were estimated, by name: value, standard deviation (None where it is not known), unit.
    """
    leading = max(verdict.effects, key=lambda e: e.size if math.isfinite(e.size) else -1.0, default=None)
    told = {} if leading is None else _leading(leading)
    before, after = (_mean_fit(verdict.counted(name)) for name in ("refit", "augmented" if leading else "refit"))
    return Row(
        dataset=row.dataset,
        card=row.card,
        machine=row.machine,
        recorded=row.recorded,
        answer=_answer(verdict, leading),
        title=verdict.dataset,
        model=verdict.model,
        sentence=verdict.sentence,
        confidence=_finite(verdict.confidence),
        fit_before=before,
        fit_after=after,
        seconds=verdict.seconds,
        complete=verdict.complete,
        report=f"{row.dataset}/report.html",
        parameters={name: dict(entry) for name, entry in parameters.items() if not _learned(name)},
        **told,
    )


def _answer(verdict: Verdict, leading: Effect | None) -> str:
    if leading is not None:
        return "unknown" if leading.mechanism in LEARNED else "named"
    if verdict.mismatch:
        return "unfinished" if verdict.could_not_say else "unknown"
    return "nothing" if verdict.complete and verdict.looked else "unfinished"


def _leading(effect: Effect) -> dict[str, Any]:
    """What the row says of the largest effect. The heights of a learned curve are no parameters of the machine."""
    told: dict[str, Any] = {
        "effect": effect.one_of.statement if effect.one_of else spoken_at(effect.mechanism, effect.port),
        "port": effect.port,
        "mechanism": effect.mechanism,
        "probability": _finite(effect.one_of.probability if effect.one_of else effect.probability),
    }
    name = next(iter(effect.parameters), None)
    if name is None or effect.mechanism in LEARNED:
        return told
    entry = effect.parameters[name]
    value, std = _finite(entry["value"]), _finite(entry.get("std"))
    return told | {"parameter": name, "value": value, "std": std, "unit": entry.get("unit", "")}


def _mean_fit(scores: Sequence[Score]) -> float | None:
    """Over the validation experiments that count; over all where there are none."""
    held_out = of_moving_outputs(held_out_scores(scores))
    return _finite(mean_fit(held_out)) if held_out else None


def _learned(name: str) -> bool:
    parts = name.split(".")
    return len(parts) == 3 and parts[1] in LEARNED


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None
