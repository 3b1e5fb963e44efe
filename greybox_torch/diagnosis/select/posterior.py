"""From evidence to probability."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from greybox_torch.diagnosis.effect import Alternative, Effect
from greybox_torch.diagnosis.hypothesis.above_noise import far_above_noise, times_noise
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.significance import overall_significance
from greybox_torch.diagnosis.refit.rank import RankedCandidate
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.study import Study


def of_a_stopped_search(effects: Sequence[Effect], settings: DiagnosisSettings) -> tuple[Effect, ...]:
    """The effects with what was not yet tried allowed for."""
    return tuple(
        replace(e, probability=min(e.probability, settings.highest_probability_of_stopped_curve))
        if e.mechanism == "unknown"
        else e
        for e in effects
    )


def for_all_that_is_left(probability: float, share: float, left: Hypothesis, settings: DiagnosisSettings) -> float:
    """The probability of a name, given what all findings together leave: much more than noise, and more than a finding is.

    Args:
        share: of the whole mismatch, that ``left`` leaves.
    """
    much = far_above_noise(left, settings) and share > settings.least_size
    return min(probability, settings.highest_probability_far_above_noise) if much else probability


def shared(
    chosen: RankedCandidate, ranked: Sequence[RankedCandidate], settings: DiagnosisSettings
) -> tuple[float, tuple[Alternative, ...]]:
    """The probability of the chosen hypothesis of a step, and those of its rivals.

    Rivals that the data cannot tell apart share it: a rival that the chosen one beats by z standard errors has the weight
    exp(−(z / temperature)² / 2), times the share of the gain that it reaches, and 1/e for every parameter that it has more.
    """
    weights: dict[tuple[str, str], float] = {}
    for rival in ranked:
        key = (rival.candidate.attachment.port, rival.candidate.attachment.mechanism.name)
        same = (
            rival.candidate.attachment.port == chosen.candidate.attachment.port
            and key[1] == chosen.candidate.attachment.mechanism.name
        )
        if not same:
            weights[key] = max(weights.get(key, 0.0), _weight(chosen, rival, settings))
    highest = settings.highest_probability
    total = 1.0 + sum(weights.values())
    rivals = sorted(((highest * w / total, *key) for key, w in weights.items()), reverse=True)
    found = tuple(Alternative(port, name, round(p, 4)) for p, port, name in rivals if p > settings.least_alternative)
    return round(highest / total, 4), found


def by_comparison(without: Hypothesis, current: Hypothesis, settings: DiagnosisSettings) -> float:
    """The probability of an effect whose rivals are not on record: from how significant its improvement on the hypothesis without it is.

    The hypothesis without it is the only rival that is known: it has the weight that :func:`shared` gives a rival z standard errors behind.
    """
    behind = overall_significance(without, current, settings)
    weight = float(np.exp(-0.5 * (behind / settings.windows_temperature) ** 2))
    return round(settings.highest_probability / (1.0 + weight), 4)


def _weight(chosen: RankedCandidate, rival: RankedCandidate, settings: DiagnosisSettings) -> float:
    if rival.gain <= 0:
        return 0.0
    behind = 0.0 if _twins(chosen, rival) else _behind(chosen, rival, settings)
    share = min(1.0, rival.gain / max(chosen.gain, 1e-12))
    simpler = np.exp(-max(0, rival.size - chosen.size))
    return float(np.exp(-0.5 * (behind / settings.windows_temperature) ** 2) * share * simpler)


def _behind(chosen: RankedCandidate, rival: RankedCandidate, settings: DiagnosisSettings) -> float:
    """Standard errors by which the chosen one is better: by the likelihood of whole records, where that told them apart."""
    if chosen.cost is None or rival.cost is None:
        return overall_significance(rival.fitted, chosen.fitted, settings)
    return float(np.sqrt(2.0 * max(0.0, rival.cost - chosen.cost)))


def _twins(chosen: RankedCandidate, rival: RankedCandidate) -> bool:
    """Whether two laws do the same to one input and one output; then what sets their fits apart is how each is computed."""
    records = chosen.fitted.problem.records
    alone = len(records.u) == 1 and len(records.y) == 1
    return alone and rival.candidate.attachment.mechanism.name in chosen.candidate.attachment.mechanism.twins


def confidence(
    study: Study, state: SearchState, effects: Sequence[Effect], complete: bool, unexplained: float | None
) -> float:
    """How sure the answer to "is anything missing?" is; a search that was stopped before it found anything is not sure of it.

    Args:
        unexplained: how many times the noise the error is, where it is clearly more and no effect explains it.
    """
    settings = study.settings
    if effects:
        return settings.highest_probability
    if not complete:
        return settings.confidence_stopped
    if unexplained is not None:
        return settings.confidence_missing_unnamed
    if times_noise(study.problem, state.current, settings) > settings.above_noise:
        return settings.confidence_nothing_above_noise
    best = max((r.gain for r in state.steps[-1].ranked), default=0.0) if state.steps else 0.0
    return settings.confidence_nothing if best < settings.least_gain else settings.confidence_nothing_with_rivals
