"""Validation experiments that a model without effects hardly simulates better than a constant would."""

from __future__ import annotations

import numpy as np

from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.estimate.comparison import mean_fit


def hardly_followed(judged: Judgement) -> bool:
    """Whether the plain model's free runs leave far more than disturbances do, and follow the validation experiments hardly better than a
    constant would.

    Seen: a crane's trolley without its friction, a mean fit of 26 %, 150 times the noise, 1.9 times over windows of a sixth of the record;
    a lamp's heater without its offset, 29 %: "nothing is missing" (0.60). Complete machines that drift were at 72 % and more.
    """
    settings = judged.settings
    far = float(np.nanmax(judged.times_noise, initial=0.0)) > settings.far_above_disturbances
    return far and mean_fit(judged.judging(judged.refit).scores) < settings.least_fit_of_free_runs
