"""Tapes as the peers take them."""

from __future__ import annotations

import numpy as np

from experiments.speed.records import arm_values, starts
from greybox_torch.simulate.tape import Tape


def records_for_peers(tape: Tape) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Parameters (13,), start states (E, 5) and torques (E, N) of a simulated tape, whose records are of one length."""
    count = len(tape.first)
    return arm_values(), starts(count), np.ascontiguousarray(tape.u[0].reshape(count, -1))
