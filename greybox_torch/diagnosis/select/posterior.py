"""From evidence to probability."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.diagnosis.beliefs import NO_BELIEFS, Beliefs
from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.hypothesis.above_noise import times_noise
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.mismatch import negligible
from greybox_torch.diagnosis.hypothesis.significance import overall_significance, white_samples
from greybox_torch.diagnosis.one_of import Alternative
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, priced_cost
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.study import Study


def of_a_stopped_search(effects: Sequence[Effect], settings: DiagnosisSettings) -> tuple[Effect, ...]:
    """The effects with what was not yet tried allowed for."""
    curve, name = settings.highest_probability_of_stopped_curve, settings.highest_probability_of_stopped_name
    return tuple(e.no_surer_than(curve if e.mechanism == "unknown" else name) for e in effects)


def shared(
    chosen: RankedCandidate,
    ranked: Sequence[RankedCandidate],
    settings: DiagnosisSettings,
    beliefs: Beliefs = NO_BELIEFS,
    led: RankedCandidate | None = None,
) -> tuple[float, tuple[Alternative, ...]]:
    """The probability of the chosen hypothesis of a step, and those of its rivals.

    Rivals that the data cannot tell apart share it: a rival that the best one beats by z standard errors has the weight
    exp(−(z / temperature)² / 2), times the share of the gain that it reaches and 1/e for every parameter that it has more, to the power
    ``share_exponent``, and the odds that are believed.

    Args:
        led: the best one by the recordings alone, where it is not the chosen one.
    """
    highest = settings.highest_probability
    rivals = shares(chosen, ranked, settings, beliefs, led, calibrated=True)
    own = round(highest - sum(p for _, p in rivals), 4)
    listed = [(r.candidate.attachment, p) for r, p in rivals if p > settings.least_alternative]
    return own, tuple(Alternative(a.port, a.mechanism.name, round(p, 4)) for a, p in listed)


def separated(
    chosen: RankedCandidate,
    ranked: Sequence[RankedCandidate],
    settings: DiagnosisSettings,
    beliefs: Beliefs = NO_BELIEFS,
    led: RankedCandidate | None = None,
) -> bool:
    """Whether no rival came near the chosen hypothesis of a step: ``beyond_doubt`` is left for it. Arguments as for :func:`shared`."""
    rivals = shares(chosen, ranked, settings, beliefs, led)
    return round(settings.highest_probability - sum(p for _, p in rivals), 4) > settings.beyond_doubt


def shares(
    chosen: RankedCandidate,
    ranked: Sequence[RankedCandidate],
    settings: DiagnosisSettings,
    beliefs: Beliefs = NO_BELIEFS,
    led: RankedCandidate | None = None,
    *,
    calibrated: bool = False,
) -> list[tuple[RankedCandidate, float]]:
    """The rivals of the chosen hypothesis of a step with their probabilities, the likeliest first; of each law at a port the best one.

    Args:
        calibrated: as they are told, and come true; otherwise as the search and classes use them, where a rival is to be excluded with
            more care. Other arguments as for :func:`shared`.
    """
    best = chosen if led is None else led
    exponent = settings.share_exponent if calibrated else 1.0
    weights: dict[tuple[str, str], tuple[float, RankedCandidate]] = {}
    for rival in ranked:
        if (key := rival.candidate.attachment.named) != chosen.candidate.attachment.named:
            weight = _recorded_weight(best, rival, settings, exponent)
            if key not in weights or weight > weights[key][0]:
                weights[key] = (weight, rival)
    own = _recorded_weight(best, chosen, settings, exponent)
    recorded = _as_likely_as_twins([(own, chosen), *weights.values()], exponent)
    found = [(weight * beliefs.weight(r.candidate.attachment), r) for weight, r in recorded]
    total, highest = sum(weight for weight, _ in found), settings.highest_probability
    found = [(rival, highest * weight / total) for weight, rival in found if rival is not chosen]
    return sorted(found, key=lambda pair: (pair[1], pair[0].candidate.attachment.named), reverse=True)


def _as_likely_as_twins(
    weighed: Sequence[tuple[float, RankedCandidate]], exponent: float
) -> list[tuple[float, RankedCandidate]]:
    """The hypotheses with their weights, none behind that of its twin by more than by the share of its gain that it reaches.

    Seen: 20 ms that pass in a servo, told as a delay of its output among others, and none of its input.
    """
    found = []
    for weight, rival in weighed:
        twins = (w * _share_of(r, rival) ** exponent for w, r in weighed if r is not rival and are_twins(r, rival))
        found.append((max([weight, *twins]), rival))
    return found


def told_of(
    chosen: RankedCandidate,
    ranked: Sequence[RankedCandidate],
    settings: DiagnosisSettings,
    beliefs: Beliefs = NO_BELIEFS,
    led: RankedCandidate | None = None,
) -> dict[tuple[str, str], float]:
    """The probabilities of the rivals as they are told, by port and law. Arguments as for :func:`shared`."""
    rivals = shares(chosen, ranked, settings, beliefs, led, calibrated=True)
    return {r.candidate.attachment.named: p for r, p in rivals}


def believed(
    taken: RankedCandidate, ranked: Sequence[RankedCandidate], settings: DiagnosisSettings, beliefs: Beliefs
) -> RankedCandidate:
    """The likeliest name by recordings and beliefs together; of those alike ``taken``, the likeliest by recordings alone."""
    if not beliefs.given or taken.unknown:
        return taken
    named = [r for r in ranked if not r.unknown]
    return max([taken, *named], key=lambda r: _believed_weight(taken, r, settings, beliefs))


def _believed_weight(
    best: RankedCandidate, rival: RankedCandidate, settings: DiagnosisSettings, beliefs: Beliefs
) -> float:
    return _recorded_weight(best, rival, settings) * beliefs.weight(rival.candidate.attachment)


def _recorded_weight(
    best: RankedCandidate, rival: RankedCandidate, settings: DiagnosisSettings, exponent: float = 1.0
) -> float:
    """The weight of a hypothesis beside the best one, by the recordings alone."""
    return 1.0 if rival is best else _weight(best, rival, settings) ** exponent


def by_comparison(without: Hypothesis, current: Hypothesis, settings: DiagnosisSettings) -> float:
    """The probability of an effect whose rivals are not on record: from how significant its improvement on the hypothesis without it is.

    The hypothesis without it is the only rival that is known: it has the weight that :func:`shared` gives a rival z standard errors behind.
    """
    behind = overall_significance(without, current, settings)
    weight = float(np.exp(-0.5 * (behind / settings.windows_temperature) ** 2))
    return round(settings.highest_probability / (1.0 + weight), 4)


def _weight(chosen: RankedCandidate, rival: RankedCandidate, settings: DiagnosisSettings) -> float:
    share = _share_of(chosen, rival)
    if share <= 0:
        return 0.0
    simpler = float(np.exp(-max(0, rival.size - chosen.size)))
    if are_twins(chosen, rival):
        return share * simpler
    if chosen.cost is not None and rival.cost is not None:
        own, rivals = (priced_cost(r, max(1, white_samples(r.fitted, settings))) for r in (chosen, rival))
        ahead = rivals - own
        return share * float(np.exp(-max(0.0, ahead) / settings.windows_temperature**2))
    behind = overall_significance(rival.fitted, chosen.fitted, settings)
    return share * simpler * float(np.exp(-0.5 * (behind / settings.windows_temperature) ** 2))


def _share_of(chosen: RankedCandidate, rival: RankedCandidate) -> float:
    """The share of the gain of a hypothesis that a rival reaches."""
    return float(np.clip(rival.gain / max(chosen.gain, 1e-12), 0.0, 1.0))


def are_twins(chosen: RankedCandidate, rival: RankedCandidate) -> bool:
    """Whether two laws do the same to one input and one output; then what sets their fits apart is how each is computed."""
    if rival.candidate.attachment.mechanism.name not in chosen.candidate.attachment.mechanism.twins:
        return False
    records = chosen.fitted.problem.records
    return len(records.u) == 1 and len(records.y) == 1


def confidence(
    study: Study, state: SearchState, effects: Sequence[Effect], complete: bool, unexplained: float | None, free: float
) -> float:
    """How sure the answer to "is anything missing?" is; a search that was stopped before it found anything is not sure of it.

    Args:
        complete: whether all was looked for that there was to look for.
        unexplained: how many times the noise the error is, where it is clearly more and no effect explains it.
        free: how many times the noise free runs of the model as it stands leave; NaN where no output shows the noise.
    """
    settings = study.settings
    if effects:
        by_parameters = [_of_the_whole(e) for e in effects if e.made_up_for]
        return min(by_parameters, default=settings.highest_probability)
    if not complete:
        return settings.confidence_stopped
    if unexplained is not None:
        return settings.confidence_missing_unnamed
    above = times_noise(study.problem, state.current, settings) > settings.above_noise
    if (above or free > settings.free_runs_to_doubt_nothing) and not negligible(study, state.plain):
        return settings.confidence_nothing_above_noise
    best = max((r.of_errors for r in state.steps[-1].ranked), default=0.0) if state.steps else 0.0
    return settings.confidence_nothing if best < settings.least_gain else settings.confidence_nothing_with_rivals


def _of_the_whole(effect: Effect) -> float:
    """The probability of an effect, or of the statement that it is told in."""
    return effect.probability if effect.one_of is None else effect.one_of.probability
