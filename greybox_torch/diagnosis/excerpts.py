"""Stretches of long recordings for searching: what a law looks like shows in some ten thousand samples as well as in a million."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.data import DataSet, Recording

LEAST = 1000
"""Samples that are left of a recording at least, however many recordings there are."""

STRIDES = 8
"""Neighbouring stretches that are compared begin so many to the length of a stretch."""


@dataclass(frozen=True)
class Excerpts:
    """A data set with its long recordings shortened, and which stretches were taken, in sentences."""

    dataset: DataSet
    sentences: tuple[str, ...] = ()


def excerpts(dataset: DataSet, most: int) -> Excerpts:
    """``dataset`` with at most about ``most`` samples of each role, of long recordings the stretch that moves most.

    Recordings of one role are shortened in proportion. Where the card gives start states, the stretch is the first one.
    """
    chosen, told = [], []
    for recording in dataset.recordings:
        total = sum(len(r) for r in dataset.recordings if r.role == recording.role)
        part = _stretch(dataset, recording, max(LEAST, len(recording) * most // total))
        chosen.append(part)
        if part is not recording:
            told.append(
                f"Of {recording.name} the search used the {len(part)} samples from {part.time[0]:.4g} s on, where most moves; "
                f"the free runs are of all {len(recording)}."
            )
    return Excerpts(replace(dataset, recordings=tuple(chosen)), tuple(told)) if told else Excerpts(dataset)


def _stretch(dataset: DataSet, recording: Recording, samples: int) -> Recording:
    if samples >= len(recording):
        return recording
    first = 0 if dataset.initial else _liveliest(recording, samples)
    # The first stretch begins where the recording does, and start states are by the recording's name.
    name = recording.name if first == 0 else f"{recording.name} from {recording.time[first]:.4g} s"
    return recording.part(first, first + samples, name=name)


def _liveliest(recording: Recording, samples: int) -> int:
    """Where the stretch begins over which the signals, each in units of its own spread, vary most; the earliest of equals."""
    begins = np.arange(0, len(recording) - samples + 1, max(samples // STRIDES, 1))
    activity = np.zeros(len(begins))
    for signal in recording.signals.values():
        known = signal[~np.isnan(signal)]
        centred = np.nan_to_num((signal - known.mean()) / (known.std() or 1.0))
        sums, squares = (np.concatenate([[0.0], np.cumsum(s)]) for s in (centred, centred**2))
        mean, square = ((s[begins + samples] - s[begins]) / samples for s in (sums, squares))
        activity += square - mean**2
    return int(begins[np.argmax(activity > 0.99 * activity.max())])
