"""How far above the noise the errors of a hypothesis are."""

from __future__ import annotations

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.noise import floor_known, noise_floor, reaches_noise
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.estimate.problem import Problem


def times_noise(problem: Problem, fitted: Hypothesis, settings: DiagnosisSettings) -> float:
    """Root mean square error in units of the noise, over the windows where it is largest: long ones show what is slow."""
    return float(np.sqrt(max(f.mean_square for f in fitted.fits) / max(noise_floor(problem, settings), 1e-300)))


def far_above_noise(fitted: Hypothesis, settings: DiagnosisSettings) -> bool:
    """Whether a hypothesis leaves much more than the noise."""
    return times_noise(fitted.problem, fitted, settings) > settings.far_above_noise


def noise_over_windows(fitted: Hypothesis, settings: DiagnosisSettings) -> bool:
    """Whether a fit leaves hardly more than noise over windows, the longest aside, where slow disturbances of the machine show."""
    fits = fitted.fits[:-1] or fitted.fits
    return all(reaches_noise(fitted.problem, fit, settings, settings.above_noise) for fit in fits)


def only_noise(problem: Problem, fitted: Hypothesis, settings: DiagnosisSettings) -> bool:
    """Whether nothing but noise is left at any window length, where the recordings tell how much of it there is."""
    largest = max(f.mean_square for f in fitted.fits)
    return floor_known(problem, settings) and largest < settings.only_noise * noise_floor(problem, settings)
