"""Laws that act in next to none of the samples that they were estimated from."""

from __future__ import annotations

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.signals_along import local_signals
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel


def acts_in_a_few_samples(fitted: Hypothesis, effect: Attachment, settings: DiagnosisSettings) -> bool:
    """Whether a law that acts beyond a value alone was estimated from samples that hardly ever are: it draws what is left in those.

    Seen: beside a fermenter's growth, a flow of 1800 per g/L above a level that one sample of 7800 lies above (0.97).
    """
    beyond = effect.mechanism.acts_beyond(effect.own(fitted.values()))
    if beyond is None:
        return False
    assert isinstance(fitted.model, AugmentedModel)
    signals = local_signals(fitted.model, effect, fitted.fits[0], fitted.simulator)
    along = signals[effect.mechanism.signals()[0]]
    below, above = (np.nan if end is None else end for end in beyond)
    return int(np.sum((along < below) | (along > above))) < settings.fewest_samples_of_a_law
