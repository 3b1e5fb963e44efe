"""Channels that never move: a sensor that is stuck, a column that was never written, an input that nobody used."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from greybox_torch.data import DataSet, Recording
from greybox_torch.data.data_warning import InASentence
from greybox_torch.name_lists import brief

if TYPE_CHECKING:
    from greybox_torch.model import GreyBoxModel


@dataclass(frozen=True)
class ConstantChannel(InASentence):
    """``value`` in the channel's unit, one text where it differs between the ``experiments``; ``lacks`` what cannot be told from it."""

    channel: str
    value: str
    experiments: tuple[str, ...]
    lacks: str
    write: str

    @property
    def found(self) -> str:
        """What is there, in a sentence."""
        named = brief([f'"{name}"' for name in self.experiments])
        one = "experiment" if len(self.experiments) == 1 else "experiments"
        return f'channel "{self.channel}" is constant ({self.value}) in {one} {named}: {self.lacks}'


def constant_channels(data: DataSet, model: GreyBoxModel | None) -> Iterator[ConstantChannel]:
    """Outputs that do not move in an experiment, and inputs that do not move in any that is estimated from.

    An input may well rest in one experiment, for a free decay or an even load. Where no model says which channels are inputs, those are
    told that move nowhere. What the card calls a constant is meant to be one: it is told of outputs alone.
    """
    inputs = None if model is None else {one.name for one in model.inputs}
    for name, channel in data.channels.items():
        resting = [recording for recording in data.recordings if rests(recording, name)]
        estimated = data.estimation() or data.recordings
        values = _values(resting, name)
        if not resting or (inputs is None and (len(resting) < len(data.recordings) or len(values) > 1)):
            continue
        if inputs is not None and name in inputs:
            resting = [recording for recording in resting if recording in estimated]
            values = _values(resting, name)
            if len(resting) < len(estimated) or len(values) > 1:
                continue
        if (inputs is None or name in inputs) and all(name in recording.constants for recording in resting):
            continue
        shown = resting_at(resting, name, channel.unit)
        yield ConstantChannel(name, shown, tuple(recording.name for recording in resting), *_told(name, inputs))


def _told(name: str, inputs: set[str] | None) -> tuple[str, str]:
    if inputs is None:
        return (
            "nothing can be learned from it",
            "a channel that moves; or is the sensor stuck, or another column meant?",
        )
    if name in inputs:
        return (
            "an input that never moves cannot show what it does",
            "an experiment in which it moves, where what it does is to be estimated or found; or another column; or, if it is a constant, "
            "no column and constants = { … } in every [[experiment]]",
        )
    return (
        "an output that never moves says nothing of what moves it",
        "a sensor that is not stuck, or no such channel and output; where the machine rested, rows in which it moves",
    )


def rests(recording: Recording, name: str) -> bool:
    """Whether a channel has one value throughout a recording."""
    values = recording.signals[name]
    return bool(np.nanmax(values) == np.nanmin(values))


def resting_at(recordings: Sequence[Recording], name: str, unit: str | None) -> str:
    """In words, where a channel rests in recordings."""
    values = _values(recordings, name)
    return (
        " ".join(filter(None, [f"{values[0]:.6g}", "" if unit == "1" else unit]))
        if len(values) == 1
        else "at a value of its own in each"
    )


def _values(recordings: Sequence[Recording], name: str) -> list[float]:
    return sorted({float(np.nanmax(recording.signals[name])) for recording in recordings})
