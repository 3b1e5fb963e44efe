"""Refitted candidates compared with one another and with the hypothesis that they build on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.refit.curves_from_laws import curves_from_laws
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, in_order, judged
from greybox_torch.diagnosis.refit.refitted import polished
from greybox_torch.diagnosis.refit.restarts import restarts
from greybox_torch.diagnosis.screen.score_test import ScreenScore
from greybox_torch.diagnosis.study import Study
from greybox_torch.simulation.side_by_side import side_by_side


@dataclass(frozen=True)
class Comparison:
    """Candidates, best first, and the hypothesis that they were compared with: the given one, or a better fit of the same."""

    parent: Hypothesis
    ranked: tuple[RankedCandidate, ...]


def compare(
    study: Study,
    parent: Hypothesis,
    screened: Sequence[Sequence[ScreenScore]],
    ranked: Sequence[RankedCandidate],
) -> Comparison:
    """The front runners polished, also from where the best one has the model's parameters, and compared with their parent from there.

    Without the first, the order among close rivals would be the luck of their start values; without the second, an effect of next
    to no size could win merely because its refit got out of a local minimum that the parent sits in.
    """
    if not ranked or ranked[0].gain < study.settings.least_gain:
        return Comparison(parent, tuple(ranked))
    front = _front(study, ranked)
    polish = side_by_side(partial(_polished, study, r.fitted, restarts(study, screened, r)) for r in front)
    best = min(polish, key=lambda fitted: fitted.score)
    pairs = zip(front, polish, strict=True)
    polish = side_by_side(partial(_from_there, study, r, fitted, best, parent.problem.names) for r, fitted in pairs)
    best = min(polish, key=lambda fitted: fitted.score)
    others = [fitted.values() for fitted in polish if fitted is not best]
    again = _polished(study, parent, [best.values(), {**best.values(), **study.card}, *others], best)
    if again.score < parent.score:
        parent, pairs = again, zip(front, polish, strict=True)
        polish = side_by_side(partial(_from_better_parent, study, r, fitted, parent) for r, fitted in pairs)
    rest = [r for r in ranked if all(r is not one for one in front)]
    fitted = [*polish, *(r.fitted for r in rest)]
    both = zip([*front, *rest], fitted, strict=True)
    compared = [judged(r.candidate, parent, one, study.settings) for r, one in both]
    return Comparison(parent, tuple(in_order(curves_from_laws(study, parent, compared), study.settings)))


def _front(study: Study, ranked: Sequence[RankedCandidate]) -> list[RankedCandidate]:
    """The first few that come near the best gain, and all that tie with it."""
    tied = sum(not r.unknown and r.gain > ranked[0].gain - study.settings.score_tie for r in ranked)
    # Not always the first of the ranking: that has a price for every parameter.
    close = [r for r in ranked if r.gain > study.settings.polish_share * ranked[0].gain]
    return close[: max(study.budget.front_runners, min(tied, study.budget.most_tied))]


def _from_there(
    study: Study, ranked: RankedCandidate, fitted: Hypothesis, best: Hypothesis, names: Sequence[str]
) -> Hypothesis:
    """A front runner polished from where the best one has the parameters ``names``; a curve as it is, whose refits are the slowest."""
    if fitted is best or ranked.unknown:
        return fitted
    values = best.values()
    return _polished(study, fitted, [{**fitted.values(), **{n: values[n] for n in names}}])


def _from_better_parent(study: Study, ranked: RankedCandidate, fitted: Hypothesis, parent: Hypothesis) -> Hypothesis:
    """A front runner that its improved parent has left behind, polished from where that has the parameters: it contains the parent, so
    that less is a local minimum. Not one that is behind in its error alone, where the parent has parameters that no machine has."""
    behind = fitted.score > parent.score - study.settings.score_tie
    if not behind or ranked.unknown:
        return fitted
    return _polished(study, fitted, [{**fitted.values(), **parent.values()}], parent)


def _polished(
    study: Study, fitted: Hypothesis, starts: Sequence[dict[str, float]], beside: Hypothesis | None = None
) -> Hypothesis:
    study.working_on(f"polishing {' + '.join(e.prefix for e in fitted.effects) or 'the model as it stands'}")
    return polished(study, fitted, starts, beside)
