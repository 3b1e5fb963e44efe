"""What an input does in the direction of a body's motion: positive where it drives, negative where it brakes."""

from __future__ import annotations

from typing import Any

import torch

from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.model.once_per_model import once_per_model
from greybox_torch.model.own_rate import balanced_state, without_laws
from greybox_torch.model.ports import Body
from greybox_torch.model.states_of import inputs_of

ALONG, DIRECTION = "along@", "direction@"
"""Beginnings of the names of such a signal, where the input's name follows, and of the direction itself, where the body's follows."""

SHARP = 0.02
"""Part of the root mean square speed by which the direction has changed."""


def direction(speed: Any, rms: float) -> Any:
    """The direction of motion, from -1 to 1, smooth about rest.

    Args:
        rms: root mean square of the speed in the recordings.
    """
    return torch.tanh(torch.as_tensor(speed) / (SHARP * max(rms, 1e-12)))


@once_per_model
def inputs_that_push(model: GreyBoxModel) -> dict[str, list[str]]:
    """By body the inputs on which the rate of its speed depends; none where that is no state of the model."""
    bodies = (q for q in model.ports if isinstance(q, Body))
    return {b.name: inputs_of(model, without_laws(model, b)) if balanced_state(model, b) else [] for b in bodies}
