"""Named hypotheses that fit windows alike, told apart by the likelihood of whole records.

At the noise every sample counts, and a slow disturbance that is in them all can make a law with one parameter more look better, or one law
better than another that does nearly the same. Errors weighed by their spectrum do not count what is slow over and over.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from greybox_torch.diagnosis.hypothesis.significance import white_samples
from greybox_torch.diagnosis.refit.likelihood import cost_of
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, priced_cost
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget

BARE_MENTION = float(np.log(3.0))
"""By how much the evidence for a law with more parameters has to be higher: odds below three are "not worth more than a bare mention"."""

LOST = 2.0
"""Times the mean square error of the best from which a free run is somewhere else, and no measure of its hypothesis."""


def rank_by_likelihood(
    ranked: Sequence[RankedCandidate], settings: DiagnosisSettings, budget: SearchBudget
) -> list[RankedCandidate]:
    """``ranked`` with the named ones that tie at the noise in the order of their likelihood, less a price for every parameter.

    The price is half the logarithm of the number of samples; of laws between which that leaves odds below three the simplest comes first.
    One whose free run is farther behind than windows that tie promise keeps its place, and counts as far behind as that: whole records do
    not speak for it. One whose free run is lost (a machine that is nearly bistable) is judged by its windows alone.

    Source: G. Schwarz, "Estimating the dimension of a model", Annals of Statistics 6, 1978; R. E. Kass, A. E. Raftery, "Bayes factors",
    Journal of the American Statistical Association 90, 1995.
    """
    named = [r for r in ranked if not r.unknown]
    best = min(named, key=lambda r: r.fitted.score, default=None)
    samples = 0 if best is None else white_samples(best.fitted, settings)
    if best is None or not samples:
        return list(ranked)
    tied = [r for r in named if r.fitted.score < best.fitted.score + settings.score_tie][: budget.most_tied]
    if len({r.candidate.attachment.prefix for r in tied}) < 2:
        return list(ranked)
    costs = [cost_of(r.fitted) for r in tied]
    within = min(costs) + 0.5 * settings.score_tie * samples
    weighed = {id(r): replace(r, cost=cost) for r, cost in zip(tied, costs, strict=True) if cost <= within}
    lost = min(costs) + 0.5 * float(np.log(LOST)) * samples
    behind = {id(r): replace(r, cost=within) for r, cost in zip(tied, costs, strict=True) if within < cost <= lost}
    in_turn = iter(_simplest_first(sorted(weighed.values(), key=lambda r: priced_cost(r, samples)), samples))
    ordered = [next(in_turn) if id(r) in weighed else r for r in ranked]
    first = next(r for r in ordered if not r.unknown)
    return ordered if first.cost is None else [behind.get(id(r), r) for r in ordered]


def _simplest_first(in_order: Sequence[RankedCandidate], samples: int) -> list[RankedCandidate]:
    """Hypotheses in the order of their priced cost, of those that come as near to the first as makes no odds the simplest before it."""
    near = [r for r in in_order if priced_cost(r, samples) <= priced_cost(in_order[0], samples) + BARE_MENTION]
    simplest = min(near, key=lambda r: r.size)
    return [simplest, *(r for r in in_order if r is not simplest)]
