"""Rates and outputs of a model where the recordings take it."""

from __future__ import annotations

from collections.abc import Mapping

import torch

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.estimate.rates_and_outputs import RatesAndOutputs
from greybox_torch.estimate.window_fit import states_along
from greybox_torch.mechanisms.augmented_model import AugmentedModel

MOST_SAMPLES = 2000
"""That are looked at, spread evenly over the records."""


def along_records(fitted: Hypothesis, model: AugmentedModel, values: Mapping[str, float]) -> RatesAndOutputs:
    """Those of ``model``, with such parameter ``values``, at no more than :data:`MOST_SAMPLES` samples of the shortest windows.

    Args:
        fitted: what brings the states along; those of ``model`` are the same.
    """
    fit = fitted.fits[0]
    states, inputs = states_along(fit, fitted.simulator).T, fit.problem.driving_records.u
    every = max(1, -(-states.shape[1] // MOST_SAMPLES))
    return RatesAndOutputs(model, values, torch.as_tensor(states[:, ::every]), torch.as_tensor(inputs[:, ::every]))
