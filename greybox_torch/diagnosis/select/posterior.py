"""From evidence to probability."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.noise import ABOVE_NOISE, far_above_noise, times_noise
from greybox_torch.diagnosis.hypothesis.significance import surely_better
from greybox_torch.diagnosis.refit.rank import RankedCandidate
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.verdict import Alternative, Effect
from greybox_torch.estimate.problem import Problem

TEMPERATURE = 2.0
"""Standard errors that count as one: windows are not independent, and no law of the library is exactly the machine's."""

UNEXPLAINED = 0.6
"""How sure "nothing is missing" is where the error is larger than the noise, and yet no effect explains any of it."""

BEYOND_EXPLANATION = 0.8
"""How sure "something is missing" is where that says so alone."""

CEILING = 0.97
"""The most that is ever claimed."""

CEILING_FAR_ABOVE_NOISE = 0.85
"""The most that is claimed for a name where the laws together leave much more than noise: one of them may stand for what has none."""

UNNAMED_SO_FAR = 0.5
"""The most that is claimed for a free curve where the search was stopped: names may not have been tried in its place."""


def of_a_stopped_search(effects: Sequence[Effect]) -> tuple[Effect, ...]:
    """The effects with what was not yet tried allowed for."""
    return tuple(
        replace(e, probability=min(e.probability, UNNAMED_SO_FAR)) if e.mechanism == "unknown" else e for e in effects
    )


def for_all_that_is_left(probability: float, share: float, left: Hypothesis, least_size: float) -> float:
    """The probability of a name, given what all findings together leave: much more than noise, and more than a finding is.

    Args:
        share: of the whole mismatch, that ``left`` leaves.
    """
    return min(probability, CEILING_FAR_ABOVE_NOISE) if far_above_noise(left) and share > least_size else probability


def shared(chosen: RankedCandidate, ranked: Sequence[RankedCandidate]) -> tuple[float, tuple[Alternative, ...]]:
    """The probability of the chosen hypothesis of a step, and those of its rivals.

    Rivals that the data cannot tell apart share it: a rival that the chosen one beats by z standard errors has the weight
    exp(−(z / temperature)² / 2), times the share of the gain that it reaches, and 1/e for every parameter that it has more.
    """
    weights: dict[tuple[str, str], float] = {}
    for rival in ranked:
        key = (rival.leader.attachment.port, rival.leader.attachment.mechanism.name)
        same = (
            rival.leader.attachment.port == chosen.leader.attachment.port
            and key[1] == chosen.leader.attachment.mechanism.name
        )
        if not same:
            weights[key] = max(weights.get(key, 0.0), _weight(chosen, rival))
    total = 1.0 + sum(weights.values())
    rivals = sorted(((CEILING * w / total, *key) for key, w in weights.items()), reverse=True)
    found = tuple(Alternative(port, name, round(p, 4)) for p, port, name in rivals if p > 0.005)
    return round(CEILING / total, 4), found


def _weight(chosen: RankedCandidate, rival: RankedCandidate) -> float:
    if rival.gain <= 0:
        return 0.0
    behind = 0.0 if _twins(chosen, rival) else _behind(chosen, rival)
    share = min(1.0, rival.gain / max(chosen.gain, 1e-12))
    simpler = np.exp(-max(0, rival.size - chosen.size))
    return float(np.exp(-0.5 * (behind / TEMPERATURE) ** 2) * share * simpler)


def _behind(chosen: RankedCandidate, rival: RankedCandidate) -> float:
    """Standard errors by which the chosen one is better: by the likelihood of whole records, where that told them apart."""
    if chosen.cost is None or rival.cost is None:
        return surely_better(rival.fitted, chosen.fitted)
    return float(np.sqrt(2.0 * max(0.0, rival.cost - chosen.cost)))


def _twins(chosen: RankedCandidate, rival: RankedCandidate) -> bool:
    """Whether two laws do the same to one input and one output; then what sets their fits apart is how each is computed."""
    records = chosen.fitted.problem.records
    alone = len(records.u) == 1 and len(records.y) == 1
    return alone and rival.leader.attachment.mechanism.name in chosen.leader.attachment.mechanism.twins


def confidence(
    problem: Problem, state: SearchState, effects: Sequence[Effect], complete: bool, unexplained: float | None
) -> float:
    """How sure the answer to "is anything missing?" is; a search that was stopped before it found anything is not sure of it.

    Args:
        unexplained: how many times the noise the error is, where it is clearly more and no effect explains it.
    """
    if effects:
        return CEILING
    if not complete:
        return 0.5
    if unexplained is not None:
        return BEYOND_EXPLANATION
    if times_noise(problem, state.current) > ABOVE_NOISE:
        return UNEXPLAINED
    best = max((r.gain for r in state.steps[-1].ranked), default=0.0) if state.steps else 0.0
    return 0.95 if best < 0.01 else 0.8
