"""Stretches of a recording in which an input of the model is missing: what drove the machine there is not known."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from greybox_torch.checking.as_in_the_file import rows_are_of_the_file, rows_on_the_card
from greybox_torch.data import DataSet, Recording
from greybox_torch.data.data_warning import InASentence
from greybox_torch.data.gaps import SAMPLES_LOST as LONGEST
from greybox_torch.data.gaps import pieces_around

if TYPE_CHECKING:
    from greybox_torch.model import GreyBoxModel


@dataclass(frozen=True)
class MissingInput(InASentence):
    """The longest stretch of missing samples of an input in an experiment: from sample ``first`` on, ``count`` of them, ``seconds`` long;
    ``missing`` of its ``samples`` in all. ``write`` says what to do.
    """

    experiment: str
    channel: str
    first: int
    count: int
    seconds: float
    missing: int
    samples: int
    write: str

    @property
    def found(self) -> str:
        """What is there, in a sentence."""
        return (
            f'[[experiment]] "{self.experiment}", channel "{self.channel}": {self.missing} of {self.samples} samples of this input are '
            f"missing, {self.count} of them ({self.seconds:.3g} s) from sample {self.first} on (the first is 0); {self._held} "
            "stands for them, which is not what drove the machine"
        )

    @property
    def _held(self) -> str:
        return "the first value after" if self.first == 0 else "the last value before"


def missing_inputs(data: DataSet, model: GreyBoxModel) -> Iterator[MissingInput]:
    """Of every experiment and input of a model, the longest stretch of missing samples, where it is longer than :data:`LONGEST`."""
    for recording in data.recordings:
        for name in (one.name for one in model.inputs if one.name in recording.signals):
            gone = np.isnan(recording.signals[name])
            edges = np.flatnonzero(np.diff(np.concatenate([[False], gone, [False]]).astype(int)))
            first, count = edges[::2], np.diff(edges)[::2]
            if len(count) and count.max() > LONGEST:
                k = int(np.argmax(count))
                seconds = float(count[k]) * recording.sample_time
                stretch = int(first[k]), int(count[k])
                write = _around(data, recording, *stretch)
                yield MissingInput(recording.name, name, *stretch, seconds, int(gone.sum()), len(gone), write)


def _around(data: DataSet, recording: Recording, first: int, count: int) -> str:
    """What to write to leave a stretch of samples out: the rows of the file, as far as samples are rows of it."""
    if rows_are_of_the_file(data):
        begin = recording.rows[0] + first
        return pieces_around((begin, begin + count), rows_on_the_card(data, recording))
    return "rows = [first, last] that leave it out: two experiments of the file, where there are samples before it and after it"
