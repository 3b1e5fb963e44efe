"""Into how many parts a step over a gap in the time stamps is divided before it is made: so many Runge-Kutta steps as elsewhere in as long
a time. What is stable and exact over a usual step is neither over one that is sixty times as long.
"""

from __future__ import annotations

import numpy as np

from greybox_torch.data.gaps import gap_steps
from greybox_torch.simulation.records import Records, once

MOST = 1000
"""Parts of one gap: after a pause of hours between two runs in one file nothing that a simulation says is of use."""


def parts_of_gaps(records: Records) -> np.ndarray | None:
    """Parts (N,) of the step after each sample, one but in gaps; None where the records have none."""
    return once(records, "parts of gaps", lambda: _parts(records))


def _parts(records: Records) -> np.ndarray | None:
    parts = np.ones(len(records.dt), dtype=np.int64)
    for experiment in range(len(records.first)):
        steps = records.dt[records.span(experiment)][:-1]
        gaps = np.flatnonzero(gap_steps(records.time(experiment)))
        usual = float(np.median(steps)) if len(gaps) else 1.0
        parts[records.first[experiment] + gaps] = np.clip(np.ceil(steps[gaps] / usual), 1, MOST)
    return parts if (parts > 1).any() else None
