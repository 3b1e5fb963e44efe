"""What a model says of the machine at given states, without simulating."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import torch

from greybox_torch.errors import UserError, did_you_mean
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.signals import parameter_signals
from greybox_torch.simulation.records import Records


def rates_at(
    model: GreyBoxModel,
    values: Mapping[str, float],
    states: Mapping[str, Any],
    inputs: Mapping[str, Any] | None = None,
) -> dict[str, np.ndarray]:
    """The rates (M,) of all states, in their units per second, of ``model`` with parameter ``values``.

    States and inputs that are not given are zero. Effects with a memory are as they would begin there, and a delayed input is as if it
    had always been so. A static law is read off in this way, alike from physics and network: friction from what slows down a machine that
    turns as one piece, a spring from what accelerates a machine at rest that is twisted.

    Args:
        states: values (M,) or numbers by state, in the states' units.
        inputs: the same by input.

    Raises:
        UserError: a state or input that the model does not have, or arrays of different lengths.
    """
    base = model.base if isinstance(model, AugmentedModel) else model
    names = [s.name for s in model.states]
    _check_names(model, "state", names, states)
    _check_names(model, "input", [i.name for i in base.inputs], inputs or {})
    given = [*(states.get(name, 0.0) for name in names), *((inputs or {}).get(i.name, 0.0) for i in base.inputs)]
    try:
        rows = np.stack(np.broadcast_arrays(*(np.atleast_1d(np.asarray(row, dtype=float)) for row in given)))
    except ValueError as error:
        raise UserError(f"rates: {error}; expected numbers, or arrays of one length") from None
    numbers = np.array([values[p.name] for p in model.declared_parameters])
    records = model.prepared(_records(rows[len(names) :], len(model.outputs)), numbers)
    begun = model.begun(rows[: len(names)].T.copy(), records, records.first, numbers)
    p = parameter_signals(values)
    with torch.no_grad():
        found = model.rates(torch.as_tensor(begun.T.copy()), torch.as_tensor(np.array(records.u)), p)
    return dict(zip(names, found.numpy(), strict=True))


def _records(u: np.ndarray, outputs: int) -> Records:
    """Every point an experiment of one sample, so that nothing is taken from its neighbour."""
    count = u.shape[1]
    each = np.arange(count)
    return Records(u, np.full((outputs, count), np.nan), np.ones(count), each, each, tuple(map(str, each)), "zoh")


def _check_names(model: GreyBoxModel, kind: str, names: list[str], given: Mapping[str, Any]) -> None:
    for name in given:
        if name not in names:
            hint, known = did_you_mean(name, names), ", ".join(names)
            raise UserError(f"rates: model {model.title} has no {kind} '{name}'{hint}; expected one of {known}")
