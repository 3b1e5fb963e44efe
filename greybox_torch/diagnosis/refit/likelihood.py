"""Hypotheses by the likelihood of whole records, with errors of whatever colour they have.

Windows are few where an effect is slow or rare, and of few their mean is not sure. Where a hypothesis leaves white noise alone every sample
counts: the likelihood says what windows cannot. What a slow disturbance could be taken for does not count over and over, as the errors of
both hypotheses are weighed by their own spectrum.

Source: P. Whittle, "Estimation and information in stationary time series", Arkiv för Matematik 2, 1953.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.significance import white_samples
from greybox_torch.diagnosis.hypothesis.whole_records import coloured, whole_runs
from greybox_torch.diagnosis.refit.ranked import RankedCandidate
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.estimate.through_windows import from_windows


def cost_of(fitted: Hypothesis) -> float:
    """Negative logarithm of the likelihood of whole records from the values of the longest windows; infinite where they overflow."""
    found = coloured(whole_runs(fitted, [from_windows(fitted.fits[-1])]))
    return np.inf if found is None else found[1].cost


def likelier(cost_before: Callable[[], float], ranked: RankedCandidate, settings: DiagnosisSettings) -> bool:
    """Whether a named candidate is surely better than the hypothesis before it by the likelihood of whole records.

    Asked only of what leaves white noise alone.

    Args:
        cost_before: gives :func:`cost_of` the hypothesis before it; called only where it is needed.
    """
    asked = not ranked.unknown and ranked.gain > settings.least_gain_by_likelihood
    if not asked or not white_samples(ranked.fitted, settings):
        return False
    cost = cost_of(ranked.fitted) if ranked.cost is None else ranked.cost
    return _beyond_doubt(cost_before() - cost, settings)


def needed_by_likelihood(without: Hypothesis, with_it: Hypothesis, settings: DiagnosisSettings) -> bool:
    """Whether a hypothesis is surely better than one without an effect of its own, as for :func:`likelier`."""
    gain = without.score - with_it.score
    if gain <= settings.least_gain_by_likelihood or not white_samples(with_it, settings):
        return False
    return _beyond_doubt(cost_of(without) - cost_of(with_it), settings)


def _beyond_doubt(further: float, settings: DiagnosisSettings) -> bool:
    """Whether the likelihood's logarithm is so much higher that windows need not say so as well."""
    return further > 0.5 * settings.least_likelihood_significance**2
