"""The signals that an effect depends on, where a hypothesis takes the recordings."""

from __future__ import annotations

import numpy as np
import torch

from greybox_torch.estimate.window_fit import WindowFit, states_along
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.simulation.simulator import Simulator


def local_signals(
    model: AugmentedModel, attachment: Attachment, fit: WindowFit, simulator: Simulator
) -> dict[str, np.ndarray]:
    """The signals that an effect depends on, along the estimation records (N,)."""
    problem, states = fit.problem, states_along(fit, simulator)
    x, u = model.named_signals(torch.as_tensor(states.T), torch.as_tensor(problem.driving_records.u))
    local = model.local_signals(attachment, x, u, problem.parameter_tensors)
    return {n: np.broadcast_to(np.asarray(v, dtype=float), states.shape[:1]) for n, v in local.items()}
