"""Validation experiments in whose beginning nothing is measured: no sample tells where their free runs start."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.data.data_warning import InASentence

if TYPE_CHECKING:
    from greybox_torch.model import GreyBoxModel


@dataclass(frozen=True)
class LateSensor(InASentence):
    """The first sample of an output in an experiment is ``seconds`` after the start."""

    experiment: str
    seconds: float
    write: str = "rows that begin with that sample in this [[experiment]], or the start states in [model.initial] where they are known"

    @property
    def found(self) -> str:
        """What is there, in a sentence."""
        return (
            f'[[experiment]] "{self.experiment}": no output has a sample in its first tenth, from which start states are estimated '
            f"(the first one is {self.seconds:.4g} s after the start); it is simulated from those of the card or the model, which may be "
            "far from where the machine was"
        )


def late_sensors(data: DataSet, model: GreyBoxModel) -> Iterator[LateSensor]:
    """Validation experiments without a sample of any output in the part that their start states are estimated on, where any is."""
    from greybox_torch.estimate.initial import samples_of_beginning  # loads torch

    told = {name for name, entry in data.initial.items() if entry.value is not None or entry.fixed}
    if all(state.name in told for state in model.states):
        return
    for recording in data.validation():
        measured = [~np.isnan(recording.signals[o.name]) for o in model.outputs if o.name in recording.signals]
        known = np.any(measured, axis=0) if measured else np.zeros(0, dtype=bool)
        first = int(np.argmax(known)) if known.any() else 0
        if first >= samples_of_beginning(len(recording)):
            yield LateSensor(recording.name, float(recording.time[first] - recording.time[0]))
