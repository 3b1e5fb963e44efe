"""Tapes as the peers take them."""

from __future__ import annotations

import numpy as np

from experiments.speed.records import arm_values, starts
from greybox_torch.simulation import Records


def records_for_peers(records: Records) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Parameters (13,), start states (E, 5) and torques (E, N) of a simulated records, whose records are of one length."""
    count = len(records.first)
    return arm_values(), starts(count), np.ascontiguousarray(records.u[0].reshape(count, -1))
