"""How much of what was measured windows compare."""

from __future__ import annotations

import numpy as np

from greybox_torch.simulation.records import Records, once
from greybox_torch.simulation.windows import Windows


def compared(records: Records, windows: Windows) -> int:
    """How many measured values of ``records`` lie within ``windows``, missing ones not counted."""
    known = once(records, "known", lambda: np.concatenate([[0], np.cumsum((~np.isnan(records.y)).sum(axis=0))]))
    ends = np.minimum(windows.start + windows.steps, windows.last + 1)
    return int((known[ends] - known[windows.start]).sum())
