"""Stretches of a recording in which an input of the model is missing: what drove the machine there is not known."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.data.data_warning import InASentence
from greybox_torch.data.gaps import SAMPLES_LOST as LONGEST

if TYPE_CHECKING:
    from greybox_torch.model import GreyBoxModel


@dataclass(frozen=True)
class MissingInput(InASentence):
    """The longest stretch of missing samples of an input in an experiment: from sample ``first`` on, ``count`` of them, ``seconds`` long;
    ``missing`` of its ``samples`` in all.
    """

    experiment: str
    channel: str
    first: int
    count: int
    seconds: float
    missing: int
    samples: int

    @property
    def found(self) -> str:
        """What is there, in a sentence."""
        return (
            f'[[experiment]] "{self.experiment}", channel "{self.channel}": {self.missing} of {self.samples} samples of this input are '
            f"missing, {self.count} of them ({self.seconds:.3g} s) from sample {self.first} on (the first is 0); the last value before "
            "stands for them, which is not what drove the machine"
        )

    @property
    def write(self) -> str:
        """What to write instead."""
        return "one experiment that ends before it and another that begins after it: rows = [first, last] in each [[experiment]]"


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
                yield MissingInput(
                    recording.name, name, int(first[k]), int(count[k]), seconds, int(gone.sum()), len(gone)
                )
