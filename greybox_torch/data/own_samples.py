"""The samples that a channel's own sensor took, where that is slower than the rest of a recording."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.gaps import without_gaps
from greybox_torch.data.recording import Recording


def own_samples(recording: Recording, channel: str) -> NDArray[np.bool_]:
    """Which samples (N,) of a recording are the channel's own: all but those between samples of a slower file or column."""
    between = recording.between.get(channel)
    return np.ones(len(recording), dtype=bool) if between is None or len(between) != len(recording) else ~between


def own_step(recording: Recording, channel: str) -> float:
    """The usual time between the channel's own samples, in s: the mean but for gaps where they are fewer than the recording's."""
    own = own_samples(recording, channel)
    steps = np.empty(0) if own.all() else without_gaps(recording.time[own])
    return float(np.mean(steps)) if len(steps) else recording.sample_time


def missing_samples(recording: Recording, channel: str) -> NDArray[np.bool_]:
    """Which of the channel's own samples (N,) are missing.

    Not what lies before the first one of a slower channel, or behind its last: nothing was sampled there.
    """
    missing, own = np.isnan(recording.signals[channel]), own_samples(recording, channel)
    known = np.flatnonzero(~missing)
    if own.all() or not len(known):
        return missing
    missing[: known[0]] = missing[known[-1] :] = False
    return missing & own
