"""How much of the plain model's mismatch is left, and what may then still be taken.

No law is exactly the machine's, and sensors are good: what the right law lacks stands far above the noise, and is small beside what it
removes. Some other law will always take up part of that. So where little of the mismatch is left, a further effect is taken only if
nothing but noise remains with it: then it completes the model.
"""

from __future__ import annotations

from greybox_torch.diagnosis.hypothesis.above_noise import times_noise
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.noise import noise_floor
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.study import Study


def remaining_share(plain: Hypothesis, fitted: Hypothesis, settings: DiagnosisSettings) -> float:
    """The share of the plain model's squared error beyond the noise that ``fitted`` leaves: the largest over the window lengths.

    Windows so short that the plain model leaves no more than noise there say nothing of it: start states take up what is missing. All is
    left where that is so of every length.
    """
    shares = []
    for before, after in zip(plain.fits, fitted.fits, strict=True):
        floor = noise_floor(after.problem, settings)
        whole = before.mean_square - floor
        if whole > settings.no_mismatch * floor:
            shares.append(max(after.mean_square - floor, 0.0) / whole)
    return max(shares, default=1.0)


def leaves_little(study: Study, plain: Hypothesis, fitted: Hypothesis) -> bool:
    """Whether what a hypothesis leaves of the mismatch of ``plain`` is less than a finding is; not where free runs show more."""
    return not study.more_is_missing and remaining_share(plain, fitted, study.settings) < study.settings.least_size


def completes(fitted: Hypothesis, settings: DiagnosisSettings) -> bool:
    """Whether a hypothesis leaves hardly more than noise at every window length (an upper bound, where part of the floor is motion)."""
    most = settings.above_noise**2
    return all(fit.mean_square < most * noise_floor(fit.problem, settings) for fit in fitted.fits)


def left_to_complete(fitted: Hypothesis, settings: DiagnosisSettings) -> float:
    """The share of its squared error that has to go before a hypothesis is complete, of the window length that lacks most."""
    left = max(
        times_noise(fitted.problem, fitted, settings), 1e-100
    )  # nothing at all, of a simulated record without noise
    return 1.0 - (settings.above_noise / left) ** 2


def little_things_are_missing(study: Study, state: SearchState) -> bool:
    """Whether the model as it stands leaves little more than noise, and what was found accounts for a small part of that.

    Of a machine whose model is complete each law takes up a little, and many follow; there one has to account for most to be a finding
    (``least_of_little``). Not where free runs have shown that more is missing.
    """
    if not state.effects or study.more_is_missing:
        return False
    settings = study.settings
    little = times_noise(study.problem, state.plain, settings) < settings.far_above_noise
    return little and remaining_share(state.plain, state.current, settings) > 1.0 - settings.least_first_of_little
