"""Records of inputs that are simulated side by side, each with parameters of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.records import Records


def records_of(inputs: Sequence[np.ndarray], like: Records, sample_time: float) -> Records:
    """Records of C inputs (n_u, N) each, to be simulated side by side."""
    count, steps = len(inputs), inputs[0].shape[1]
    total = count * steps
    first = steps * np.arange(count, dtype=np.int64)
    return Records(
        u=np.ascontiguousarray(np.concatenate(inputs, axis=1)),
        y=np.zeros((len(like.y), total)),
        dt=np.full(total, sample_time),
        first=first,
        last=first + steps - 1,
        names=tuple(str(k) for k in range(count)),
        hold=like.hold,
    )


def prepared_each(model: GreyBoxModel, records: Records, values: np.ndarray) -> Records:
    """The records that drive a model, see :meth:`GreyBoxModel.prepared`, where experiment c has the parameters ``values[c]``, (C, n_p)."""
    whole = model.prepared(records, values[0])
    if whole is records or (values == values[0]).all():
        return whole
    own = [model.prepared(records.part([records.span(c)], [""]), row).u for c, row in enumerate(values)]
    return replace(records, u=np.concatenate(own, axis=1))


def begun_each(
    model: GreyBoxModel, states: np.ndarray, records: Records, samples: np.ndarray, values: np.ndarray
) -> np.ndarray:
    """Start states (C, n_x) at ``samples`` (C,), see :meth:`GreyBoxModel.begun`, with the parameters ``values`` (C, n_p)."""
    found = states.copy()
    rows, which = np.unique(values, axis=0, return_inverse=True)
    for k, row in enumerate(rows):
        same = which.ravel() == k
        found[same] = model.begun(states[same], records, samples[same], row)
    return found
