"""Which of the refitted hypotheses is taken."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.noise import far_above_noise
from greybox_torch.diagnosis.hypothesis.significance import surely_better, white_samples
from greybox_torch.diagnosis.refit.rank import RankedCandidate
from greybox_torch.diagnosis.select.remaining import completes, difference

LEAST_GAIN = 0.01
"""Improvement of the mean squared error (as a share, averaged over window lengths) below which nothing is claimed."""

LEAST_GAIN_FAR_ABOVE_NOISE = 0.05
"""The same where a hypothesis leaves much more than noise: a real machine differs from its model in many small ways, to which some law of
the library will always bend a little."""

LEAST_SIGNIFICANCE = 3.0
"""Standard errors (over windows) by which an effect must improve the prediction."""

CURVE_MARGIN = 0.1
"""How much better, in the logarithm of the mean squared error, a free curve must be than every named mechanism to be preferred."""


def least_gain(fitted: Hypothesis) -> float:
    """The improvement that an effect of ``fitted`` has to bring to be claimed."""
    return LEAST_GAIN_FAR_ABOVE_NOISE if far_above_noise(fitted) else LEAST_GAIN


def chosen(ranked: Sequence[RankedCandidate], plain: Hypothesis, least_size: float) -> RankedCandidate | None:
    """The best of the hypotheses that pay: a named mechanism, unless a free curve is better by a margin and much better.

    Args:
        plain: the model as it stands.
        least_size: the share of its mismatch by which a law must go farther than a simpler one that it contains.
    """
    named = simplest([r for r in ranked if not r.unknown], plain, least_size)
    curve = next((r for r in ranked if r.unknown), None)
    if named is None or curve is None:
        return named or curve
    much_better = curve.gain > 1.5 * named.gain or alone_at_noise(curve.fitted, named.fitted)
    return curve if curve.gain > named.gain + CURVE_MARGIN and much_better else named


def alone_at_noise(curve: Hypothesis, named: Hypothesis) -> bool:
    """Whether a free curve leaves white noise alone and names do not: then they are not the machine's, however far they come."""
    return white_samples(curve) > 0 and not white_samples(named)


def simplest(ranked: Sequence[RankedCandidate], plain: Hypothesis, least_size: float) -> RankedCandidate | None:
    """The best, or what it generalises where it is not better than that by more than chance, or by less than a finding is.

    The latter does not count against a law that leaves noise alone where the simpler one does not.
    """
    best = next(iter(ranked), None)
    if best is None:
        return None
    contained = best.leader.attachment.mechanism.generalises
    simpler = (
        r
        for r in ranked
        if r.leader.attachment.mechanism.name in contained and r.leader.attachment.port == best.leader.attachment.port
    )
    alone = completes(best.fitted)

    def as_good(r: RankedCandidate) -> bool:
        small = difference(plain, r.fitted, best.fitted) < least_size
        return surely_better(r.fitted, best.fitted) < LEAST_SIGNIFICANCE or (small and not alone)

    return next((r for r in simpler if as_good(r)), best)
