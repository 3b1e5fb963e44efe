"""The top of the page: the verdict in one sentence, and the few numbers that matter most."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.estimate.comparison import Score, held_out_scores
from greybox_torch.report import text


@dataclass(frozen=True)
class Figure:
    """A number with its name; ``before`` is empty where there is nothing to compare it with."""

    label: str
    before: str
    after: str
    note: str = ""


@dataclass(frozen=True)
class Headline:
    """``answer`` is "found", "nothing" or "unknown"; ``complete`` whether the search ran to its end."""

    dataset: str
    model: str
    sentence: str
    answer: str
    figures: tuple[Figure, ...]
    complete: bool
    not_tried: tuple[str, ...] = ()
    beside: tuple[str, ...] = ()
    template: str = "headline.html.j2"

    @classmethod
    def of(cls, verdict: Verdict) -> Headline:
        unknown = not verdict.effects or any(e.mechanism == "unknown" for e in verdict.effects)
        answer = "nothing" if verdict.looked and not verdict.mismatch else "unknown" if unknown else "found"
        figures = [_fit(verdict), *_errors(verdict)]
        if verdict.mismatch or (verdict.complete and verdict.looked):
            figures.append(_confidence(verdict))
        told = (verdict.dataset, verdict.model, text.with_minus(verdict.sentence), answer, tuple(figures))
        beside = (*verdict.asked, *verdict.of_no_use, *verdict.no_longer_validation, *verdict.short_validation)
        return cls(*told, verdict.complete, verdict.not_tried.sentences(), beside)


def held_out(verdict: Verdict, model: str, output: str | None = None) -> list[Score]:
    """The scores that a model reached on the validation experiments that count, where there are any; on all otherwise."""
    return held_out_scores([s for s in verdict.counted(model) if output is None or s.output == output])


def units(verdict: Verdict) -> dict[str, str]:
    """Units by output."""
    return {trace.output: trace.unit for trace in verdict.traces}


def pooled(scores: list[Score]) -> float:
    """Root mean square over experiments of their root mean square errors."""
    return float(np.sqrt(np.mean([s.rmse**2 for s in scores])))


def digits_of_fit(verdict: Verdict) -> int:
    """Decimals that a fit in % is given with: more where some come so close to 100 that one would hide the difference."""
    return 2 if any(s.fit > 99 for scores in verdict.scores.values() for s in scores) else 1


def _fit(verdict: Verdict) -> Figure:
    digits = digits_of_fit(verdict)
    before, after = (
        text.fit(float(np.mean([s.fit for s in held_out(verdict, m)])), digits) for m in ("refit", "augmented")
    )
    many = len(held_out(verdict, "refit")) > 1
    label = "Validation fit" + (", mean" if many else "")
    if not verdict.effects:
        return Figure(label, "", before, "the model re-estimated, nothing added")
    return Figure(label, before, after, "re-estimated as it was → with the effects attached")


def _errors(verdict: Verdict) -> list[Figure]:
    figures = []
    outputs = list(dict.fromkeys(s.output for s in verdict.scores["refit"]))
    for output in outputs:
        of = units(verdict).get(output, "")
        before, after = (text.number(pooled(held_out(verdict, m, output))) for m in ("refit", "augmented"))
        label = f"Validation error of {text.words(output)}"
        note = f"root mean square, {text.unit(of)}" if text.unit(of) else "root mean square"
        figures.append(Figure(label, before if verdict.effects else "", after if verdict.effects else before, note))
    return figures


def _confidence(verdict: Verdict) -> Figure:
    what = "that something is missing" if verdict.mismatch else "that these recordings show nothing more"
    if not verdict.effects and not verdict.complete:
        what += ", as far as a search says that was stopped"
    return Figure("Confidence", "", f"{verdict.confidence:.2f}", what)
