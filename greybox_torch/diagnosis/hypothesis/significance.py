"""How significantly one hypothesis is better than another: by windows or, at the noise, by likelihood."""

from __future__ import annotations

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.noise import reaches_noise
from greybox_torch.diagnosis.settings import DiagnosisSettings

NEARLY_ALL = 0.9
"""Share of the energy from which it counts how alike windows are in losing it. A curve removed 0.8 of two tanks' by chance."""


def overall_significance(worse: Hypothesis, better: Hypothesis, settings: DiagnosisSettings) -> float:
    """How many standard errors ``better`` is better: by windows or, at the noise, by likelihood."""
    return max(window_significance(worse, better, settings), likelihood_significance(worse, better, settings))


def likelihood_significance(worse: Hypothesis, better: Hypothesis, settings: DiagnosisSettings) -> float:
    """Standard errors by which the likelihood of white noise puts ``worse`` behind; zero where more than that is left."""
    return float(np.sqrt(max(0.0, white_samples(better, settings) * (worse.score - better.score))))


def white_samples(fitted: Hypothesis, settings: DiagnosisSettings) -> int:
    """How many samples tell hypotheses apart by likelihood: all of them where this one leaves white noise alone, else none."""
    worst = max(fitted.fits, key=lambda fit: fit.mean_square)
    if not reaches_noise(fitted.problem, worst, settings):
        return 0
    return int(np.sum(~np.isnan(fitted.problem.records.y)))


def over_the_same_windows(before: Hypothesis, after: Hypothesis) -> bool:
    """Whether two hypotheses were fitted to the same experiments: steps of a search with fewer have other windows."""
    if before is after:
        return True
    pairs = zip(before.fits, after.fits, strict=False)
    return all(len(old.energies) == len(new.energies) for old, new in pairs)


def too_few_windows(fitted: Hypothesis, settings: DiagnosisSettings) -> bool:
    """Whether there are at no length as many windows as a standard error needs."""
    return all(len(fit.energies) < settings.fewest_windows for fit in fitted.fits)


def window_significance(before: Hypothesis, after: Hypothesis, settings: DiagnosisSettings) -> float:
    """How many standard errors the improvement is away from none: the largest over the window lengths.

    Judged over windows, so that errors which are correlated within a window count once: by the mean difference of the windows'
    energies; by the mean of their logarithmic ratio, which sees an effect whose size varies by orders of magnitude; by how far the
    ratio of a single window stands out from that of the others, which sees an effect that acts at one place of the record (a stop); and,
    where nearly all of the energy goes, by how alike the windows are in that.
    """
    best = 0.0
    for old, new in zip(before.fits, after.fits, strict=True):
        if len(old.energies) >= settings.fewest_windows:
            least = 1e-12 * float(old.energies.max())
            ratio = np.log(np.maximum(old.energies, least)) - np.log(np.maximum(new.energies, least))
            best = max(
                best,
                _standard_errors(old.energies - new.energies),
                _standard_errors(ratio),
                _standing_out(ratio, settings.least_ratio_spread),
                _nearly_all_removed(old.energies, new.energies),
            )
    return best


def _standing_out(ratio: np.ndarray, least_spread: float) -> float:
    """How far the largest log ratio lies from the middle, in robust standard deviations, halved because it is the largest of many."""
    middle = float(np.median(ratio))
    spread = 1.4826 * float(np.median(np.abs(ratio - middle))) + least_spread
    return 0.5 * (float(ratio.max()) - middle) / spread


def _standard_errors(values: np.ndarray) -> float:
    spread = float(np.std(values, ddof=1)) / np.sqrt(len(values))
    return float(values.mean()) / max(spread, 1e-300)


def _nearly_all_removed(before: np.ndarray, after: np.ndarray) -> float:
    """By how many standard errors the share of the energy that goes lies above zero, as normal deviates; zero where much of it stays.

    Windows whose energies differ by orders of magnitude scatter by that, however alike the share is that each loses. The share is a ratio
    estimate, and only windows that have energy say anything of it: Student's t with as many degrees of freedom as their effective number,
    less one. Seen: a weight that a fan lifts: 95 % of the error gone, and the mean over windows 2.2 standard errors from zero.

    Source: W. G. Cochran, Sampling Techniques, 1977, section 2.11; L. Kish, Survey Sampling, 1965, for the effective number.
    """
    total = float(before.sum())
    share = float((before - after).sum()) / max(total, 1e-300)
    freedom = total**2 / max(float((before**2).sum()), 1e-300) - 1.0
    if share < NEARLY_ALL or freedom <= 0.0:
        return 0.0
    from scipy.special import ndtri, stdtr  # not every diagnosis needs it

    scatter = float(np.std(before - after - share * before, ddof=1)) * np.sqrt(len(before)) / total
    chance = float(stdtr(freedom, -share / max(scatter, 1e-12)))
    return float(-ndtri(max(chance, 1e-300)))
