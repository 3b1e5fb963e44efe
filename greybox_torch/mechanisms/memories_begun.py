"""The values that the memories of attached laws begin a window with."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import torch

from greybox_torch.model import Signals
from greybox_torch.model.signals import parameter_signals

if TYPE_CHECKING:
    from greybox_torch.mechanisms.augmented_model import AugmentedModel


def memories_begun(
    model: AugmentedModel, states: np.ndarray, records: Any, samples: np.ndarray, values: np.ndarray
) -> np.ndarray:
    """Start states (W, n_x) with the memories that begin as their surroundings say, those of inner layers first.

    What is attached to a model with effects sees what these pass on, and these see the inputs that it passes on to them.

    Args:
        states: (W, n_x), the model's own states at the windows' first samples.
        records: the recording; ``u`` (n_u, N).
        samples: (W,), the windows' first samples.
        values: of the declared parameters.
    """
    base, result = model.base, states.copy()
    pairs = zip(model.declared_parameters, values, strict=True)
    p = parameter_signals({q.name: v for q, v in pairs})
    own, inner = len(base.states), records
    if isinstance(base, type(model)):
        x, u = _begin(model, result, records, samples, p)
        acting = model.paths.inputs(x, u, p)[0]
        passed_on = records.u.copy()
        for row, one in zip(passed_on, base.inputs, strict=False):
            row[samples] = acting[one.name].numpy()
        inner = replace(records, u=passed_on)
    result[:, :own] = base.begun(result[:, :own], inner, samples, values[: len(base.declared_parameters)])
    _begin(model, result, records, samples, p)
    return result


def _begin(
    model: AugmentedModel, states: np.ndarray, records: Any, samples: np.ndarray, p: Signals
) -> tuple[Signals, Signals]:
    """Set the memories of the attached laws in ``states`` (W, n_x); the states with them, and the inputs."""
    names = [s.name for s in model.states]
    x, u = model.named_signals(torch.as_tensor(states.T.copy()), torch.as_tensor(records.u[:, samples]))
    forces = model.shown_forces(x, {}, u, p, model.local.no_forces(), x)
    at = model.signals_at(x, u, p, forces)
    for a in (a for a in model.attachments if a.mechanism.states(model.surroundings[a.port])):
        begun = a.mechanism.starts(at(a))
        for name, value in begun.items():
            states[:, names.index(f"{a.prefix}.{name}")] = np.asarray(value)
        if a.prefix not in model.probed:  # what it passes on begins where its memory does
            x = x.replaced(**{f"{a.prefix}.{name}": torch.as_tensor(value) for name, value in begun.items()})
            at = model.signals_at(x, u, p, forces)
    return x, u
