"""Stretches in which a channel stays exactly the same although it has noise everywhere else: a sensor that is stuck, or a cut lead."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from greybox_torch.checking.as_in_the_file import as_in_the_file, rows_are_of_the_file, rows_on_the_card
from greybox_torch.checking.sensor_noise import LONG, Runs, noise_of
from greybox_torch.data import DataSet, Recording
from greybox_torch.data.data_warning import InASentence
from greybox_torch.data.gaps import pieces_around
from greybox_torch.in_unit import in_unit

if TYPE_CHECKING:
    from greybox_torch.model import GreyBoxModel

_SMALL = 0.05
"""Of its range: the standard deviation up to which noise of an input is a sensor's, and not a random excitation, which may well pause."""


@dataclass(frozen=True)
class StuckSensor(InASentence):
    """The longest of ``count`` such stretches of a channel in an experiment, the rows [start, stop) of the file, which last from ``begin``
    to ``end`` (s after the start); ``value`` has its unit. ``in_file``: whether the rows are those of its
    file; ``or_held``: what else it may be, of a command.
    """

    experiment: str
    channel: str
    value: str
    rows: tuple[int, int]
    begin: float
    end: float
    count: int
    write: str
    in_file: bool
    or_held: str

    @property
    def found(self) -> str:
        """What is there, in a sentence."""
        start, stop = self.rows
        rows = f", rows = [{start}, {stop}]" if self.in_file else ""
        others = f" (and {self.count - 1} more such stretch{'es' * (self.count > 2)})" if self.count > 1 else ""
        return (
            f'[[experiment]] "{self.experiment}", channel "{self.channel}": {stop - start} samples are exactly {self.value}{rows}, '
            f"{self.begin:.6g} to {self.end:.6g} s after the start{others}; elsewhere noise changes it "
            f"with nearly every sample, as where a sensor was stuck{self.or_held}"
        )


def stuck_sensors(data: DataSet, model: GreyBoxModel | None) -> Iterator[StuckSensor]:
    """Of every channel of every experiment the longest such stretch. What is constant throughout is another warning.

    None is told at 0: a speed that is computed from an encoder is exactly 0 at rest, a current where the drive is off; and none at the ends
    of the channel's range, where commands are limited and sensors clipped. Inputs are told where their noise is small and an output moves
    meanwhile: a command that is computed from an encoder rests with the machine. Without a model any channel may be an input.
    """
    outputs = None if model is None else {one.name for one in model.outputs}
    for recording in data.recordings:
        for name in recording.signals:
            values = recording.measured(name)
            known = np.flatnonzero(~np.isnan(values))
            is_output = outputs is not None and name in outputs
            stretches = _stretches(values[known], is_output=is_output)
            stretches = [(int(known[start]), int(known[stop - 1]) + 1) for start, stop in stretches]
            if not is_output:
                stretches = [one for one in stretches if _others_move(recording, name, one, outputs)]
            if stretches:
                longest = max(stretches, key=lambda one: one[1] - one[0])
                yield _told(data, recording, name, longest, len(stretches), is_output)


def _stretches(values: NDArray[np.float64], *, is_output: bool) -> list[tuple[int, int]]:
    """The samples [start, stop) of each, among values (N,), none of them missing."""
    if len(values) < 2:
        return []
    runs = Runs.of(values)
    long = runs.lengths >= LONG
    if not long.any() or long.all():
        return []
    ends = float(values.min()), float(values.max())
    of_run = values[runs.starts]
    noise = noise_of(runs, long | np.isin(of_run, ends))  # where it is clipped, it is so in short runs as well
    if noise is None or (not is_output and noise.deviation > _SMALL * (ends[1] - ends[0])):
        return []
    meant = long & ~np.isin(of_run, (0.0, *ends))
    pairs = zip(runs.starts[meant].tolist(), runs.lengths[meant].tolist(), strict=True)
    return [(start, start + length) for start, length in pairs if noise.beside(start, start + length)]


def _others_move(recording: Recording, name: str, rows: tuple[int, int], outputs: set[str] | None) -> bool:
    """Whether another channel, an output where these are known, changes meanwhile."""
    others = [other for other in (outputs or recording.signals) if other != name and other in recording.signals]
    parts = [recording.signals[other][slice(*rows)] for other in others]
    return any(np.nanmax(part) > np.nanmin(part) for part in parts if not np.isnan(part).all())


def _told(
    data: DataSet, recording: Recording, name: str, stretch: tuple[int, int], count: int, is_output: bool
) -> StuckSensor:
    start, stop = stretch
    first = recording.rows[0]
    rows = first + start, first + stop
    value = in_unit(f"{recording.signals[name][start]:.6g}", data.channels[name].unit or "")
    begin, end = (float(recording.time[k] - recording.time[0]) for k in (start, stop - 1))
    in_file = rows_are_of_the_file(data)
    pieces = pieces_around(rows, rows_on_the_card(data, recording)) if in_file else _around(begin, end)
    _, column = as_in_the_file(data, recording, name, start)
    marked = f", or missing = {column[start]:.12g} in the channel's line on the card" if column is not None else ""
    write = f"empty cells or NaN there, which are missing samples{marked}; or {pieces}" if is_output else pieces
    held = "" if is_output else ", or a command was held"
    nothing = f"{write}; nothing, if it was measured so"
    return StuckSensor(recording.name, name, value, rows, begin, end, count, nothing, in_file, held)


def _around(begin: float, end: float) -> str:
    return f"two experiments of the same file, one before {begin:.6g} s after the start and one after {end:.6g} s"
