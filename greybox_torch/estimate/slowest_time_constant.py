"""The slowest time constant of a machine by its model, over the recordings."""

from __future__ import annotations

import numpy as np
import torch

from greybox_torch.estimate.measured_states import measured_at
from greybox_torch.estimate.problem import Problem
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.own_friction import has_dry_friction
from greybox_torch.model.ports import Body
from greybox_torch.model.sensed_states import sensed_states
from greybox_torch.model.signals import parameter_signals
from greybox_torch.simulation.records import Records

SAMPLES = 20
"""Places along the recordings that the model is linearised at: a machine that begins at rest has another time constant there."""


def slowest_time_constant(model: GreyBoxModel, problem: Problem) -> float | None:
    """The largest time constant, in s, of a model linearised at a sample, the least of several samples; None where none decays, where none
    is known, or where a body has dry friction: near rest, the rounded law is a damper so strong that all else seems slow.

    States that outputs show are as recorded, speeds of shown positions their rates, all others as they begin.

    Args:
        problem: its values, start states and records.
    """
    values = {q.name: problem.values_by_name[q.name] for q in model.declared_parameters}
    samples = np.unique(np.linspace(0, problem.records.y.shape[1] - 1, SAMPLES).astype(int))
    try:
        recorded = _recorded(model, problem.records)
        fastest = {name: float(np.abs(shown).max()) for name, shown in recorded.items()}
        if has_dry_friction(model, fastest, values):
            return None
        x = torch.as_tensor(_states(model, problem, recorded, samples))
        u, p = torch.as_tensor(problem.records.u[:, samples]), parameter_signals(values)
        matrices = torch.autograd.functional.jacobian(lambda s: model.rates(s, u, p).sum(dim=1), x).numpy()
        slowest = [_slowest(matrices[:, :, k]) for k in range(len(samples))]
    except Exception:  # equations may do anything; what is wrong with them is told where they are run
        return None
    return min((one for one in slowest if one is not None), default=None)


def _slowest(matrix: np.ndarray) -> float | None:
    """The largest time constant of dx/dt = A x with ``matrix`` A (n_x, n_x)."""
    if not np.isfinite(matrix).all():
        return None
    decay = -np.linalg.eigvals(matrix).real
    slow = decay[decay > 1e-9 * np.abs(decay).max(initial=0.0)]
    return float(1.0 / slow.min()) if len(slow) else None


def _states(model: GreyBoxModel, problem: Problem, recorded: dict[str, np.ndarray], samples: np.ndarray) -> np.ndarray:
    """The states (n_x, W) at some samples (W,), as far as recordings show them."""
    experiments = np.searchsorted(problem.records.first, samples, side="right") - 1
    begun = problem.initial[experiments].T
    return np.stack([recorded[s.name][samples] if s.name in recorded else begun[i] for i, s in enumerate(model.states)])


def _recorded(model: GreyBoxModel, records: Records) -> dict[str, np.ndarray]:
    """By state, what the recordings show of it at all samples (N,)."""
    everywhere, sensed = np.arange(records.y.shape[1]), sensed_states(model)
    shown = {
        state.name: measured_at(model, state, records, everywhere)
        for state in model.states
        if state.name in sensed or state.initial == "measured"
    }
    for body in model.ports:
        if isinstance(body, Body) and isinstance(body.speed, str) and body.position in sensed:
            shown.setdefault(body.speed, _rate(shown[str(body.position)], records))
    return shown


def _rate(values: np.ndarray, records: Records) -> np.ndarray:
    """How fast something changes (N,), experiment by experiment."""
    spans = [records.span(e) for e in range(len(records.names))]
    return np.concatenate([np.gradient(values[span], records.time(e)) for e, span in enumerate(spans)])
