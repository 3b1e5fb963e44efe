"""Which of the refitted hypotheses is taken."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.diagnosis.hypothesis.above_noise import far_above_noise, noise_over_windows
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.noise import floor_known
from greybox_torch.diagnosis.hypothesis.significance import overall_significance, white_samples
from greybox_torch.diagnosis.hypothesis.size import size
from greybox_torch.diagnosis.refit.likelihood import cost_of
from greybox_torch.diagnosis.refit.ranked import RankedCandidate
from greybox_torch.diagnosis.screen.shortlist import contains
from greybox_torch.diagnosis.select.remaining import completes
from greybox_torch.diagnosis.settings import DiagnosisSettings


def least_gain(fitted: Hypothesis, settings: DiagnosisSettings) -> float:
    """The improvement that an effect of ``fitted`` has to bring to be claimed.

    Where the recordings do not tell how much noise there is, what is left may be anything, and a law that bends a little to it is none.
    """
    anything = far_above_noise(fitted, settings) or not floor_known(fitted.problem, settings)
    return settings.least_gain_far_above_noise if anything else settings.least_gain


def chosen(
    ranked: Sequence[RankedCandidate],
    plain: Hypothesis,
    settings: DiagnosisSettings,
    parent: Hypothesis | None = None,
) -> RankedCandidate | None:
    """The best of the hypotheses that pay: a named mechanism, unless a free curve is better by a margin and much better.

    Args:
        plain: the model as it stands.
        parent: what they build on, by default ``plain``.
    """
    named = simplest([r for r in ranked if not r.unknown], plain, settings, parent)
    curve = next((r for r in ranked if r.unknown), None)
    if named is None or curve is None:
        return named or curve
    much_better = curve.gain > settings.curve_gain_ratio * named.gain or alone_at_noise(
        curve.fitted, named.fitted, plain, settings
    )
    return curve if curve.gain > named.gain + settings.curve_margin and much_better else named


def part_of_a_curve(led: RankedCandidate, paying: Sequence[RankedCandidate], settings: DiagnosisSettings) -> bool:
    """Whether a name removes but a part of what a free curve removes, which by itself is no finding: then it is none either."""
    most = max((r.gain for r in paying if r.unknown), default=0.0)
    return not led.unknown and most > settings.curve_far_ahead * led.gain


def as_unsure_as_a_name(
    led: RankedCandidate, parent: Hypothesis, in_turn: Sequence[RankedCandidate], settings: DiagnosisSettings
) -> bool:
    """Whether a free curve leads where windows leave hardly more than noise, and goes hardly farther than a name that is not sure itself.

    Seen: a complete arm whose slow drift a constant force drew nearly as well, which was not sure; the curve was told (0.95).
    """
    if not led.unknown or not noise_over_windows(parent, settings):
        return False
    names = [r for r in in_turn if not r.unknown and r.gain > settings.least_gain]
    return bool(names) and chosen([names[0], led], parent, settings) is names[0]


def alone_at_noise(curve: Hypothesis, named: Hypothesis, plain: Hypothesis, settings: DiagnosisSettings) -> bool:
    """Whether a free curve leaves white noise alone, and names as much more as a finding is: then they are not the machine's.

    What is less, of the mismatch of the model as it stands (``plain``), any law lacks to be the machine's. What whole records do not bear
    out, at the price of the curve's parameters, few windows may show by chance. Seen: a stage's drag, which left 0.2 standard errors of its
    windows to a curve (0.97), and a small constant force.
    """
    if not white_samples(curve, settings) or white_samples(named, settings):
        return False
    if size(plain.fits, named.fits, curve.fits, settings) <= settings.least_size_at_noise:
        return False
    return price_in_likelihood(named, curve, settings) < cost_of(named) - cost_of(curve)


def price_in_likelihood(fewer: Hypothesis, more: Hypothesis, settings: DiagnosisSettings) -> float:
    """By how much the likelihood's logarithm has to be higher for what ``more`` has beyond ``fewer``: log(N) / 2 for every parameter."""
    further = int(more.problem.free.sum()) - int(fewer.problem.free.sum())
    return 0.5 * further * float(np.log(max(white_samples(more, settings), 1)))


def simplest(
    ranked: Sequence[RankedCandidate],
    plain: Hypothesis,
    settings: DiagnosisSettings,
    parent: Hypothesis | None = None,
) -> RankedCandidate | None:
    """The best, or what it generalises where it is not better than that by more than chance, or by less than a finding is.

    The latter does not count against a law that leaves noise alone where the simpler one does not. Any law with fewer parameters goes
    before one that ties with it and differs from it by next to nothing of the mismatch (``same_share``): good sensors show such
    differences, and they are not the law's. Not where both leave white noise alone: there the likelihood has told them apart.
    """
    best = next(iter(ranked), None)
    if best is None:
        return None
    simpler = (r for r in ranked if contains(best.candidate.attachment, r.candidate.attachment))
    alone = completes(best.fitted, settings)

    def as_good(r: RankedCandidate) -> bool:
        by_chance = overall_significance(r.fitted, best.fitted, settings) < settings.least_significance
        return by_chance or (not alone and _lacks_little(parent or plain, r.fitted, best.fitted, settings))

    def the_same(r: RankedCandidate) -> bool:
        near = r.fitted.score < best.fitted.score + settings.score_tie
        little = size(plain.fits, r.fitted.fits, best.fitted.fits, settings) < settings.same_share
        by_likelihood = r.cost is not None and best.cost is not None
        return r.size < best.size and near and little and not by_likelihood

    return next((r for r in simpler if as_good(r)), next((r for r in ranked if the_same(r)), best))


def _lacks_little(parent: Hypothesis, simpler: Hypothesis, better: Hypothesis, settings: DiagnosisSettings) -> bool:
    """Whether a law lacks no more beside a better one than any law lacks to be the machine's, in parts of what it removes from ``parent``.

    Less than a finding is, unless it is more than that and most of what the law leaves. Seen: the LuGre friction of a table, told as
    Coulomb friction (0.85) for a difference of 1.6 %, which was 78 % of what that left; a reducer's Stribeck friction, told as Coulomb
    friction (0.85), for beside the wind on the antenna that was found first all of it was little.
    """
    lacking = size(parent.fits, simpler.fits, better.fits, settings)
    most = size(simpler.fits, simpler.fits, better.fits, settings) > settings.most_of_the_mismatch
    return lacking < (settings.least_size_at_noise if most else settings.least_size)


def priced_score(fitted: Hypothesis, settings: DiagnosisSettings) -> float:
    """Score with a little for every parameter; lower is better."""
    return fitted.score + settings.parameter_price * int(fitted.problem.free.sum())
