"""Records of inputs that are simulated side by side."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

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
