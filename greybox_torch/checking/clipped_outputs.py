"""Outputs that often stay at exactly the largest or smallest value that they ever have: beyond it, their sensor measures nothing."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from greybox_torch.checking.as_in_the_file import as_in_the_file, rows_are_of_the_file
from greybox_torch.checking.error_codes import far_off
from greybox_torch.checking.sensor_noise import LONG, Runs, noise_of
from greybox_torch.data import DataSet, Recording
from greybox_torch.data.data_warning import InASentence
from greybox_torch.in_unit import in_unit

if TYPE_CHECKING:
    from greybox_torch.model import GreyBoxModel

_PLATEAU = 4
"""Equal samples in a row from which they are a plateau."""
_OFTEN, _SAMPLES = 3, 20
"""Plateaus, and samples on them, from which a channel is clipped: noise has its extreme value once, and hardly ever twice in a row."""
_SHOWN = 3
"""Plateaus of which the rows are told."""


@dataclass(frozen=True)
class ClippedOutput(InASentence):
    """``count`` plateaus with ``samples`` samples of an output in an experiment, at its ``largest`` value or the smallest, which is
    ``value``, with its unit. ``rows`` are those of the longest, [start, stop) in the file (``in_file``) or in what the card makes
    of it.
    """

    experiment: str
    channel: str
    value: str
    largest: bool
    samples: int
    count: int
    rows: tuple[tuple[int, int], ...]
    write: str
    in_file: bool

    @property
    def found(self) -> str:
        """What is there, in a sentence."""
        rows = ", ".join(f"[{start}, {stop}]" for start, stop in self.rows)
        end = "largest" if self.largest else "smallest"
        longest = "the longest with " if self.count > len(self.rows) else ""
        several = f" in {self.count} stretches" if self.count > 1 else ""
        where = f", {longest if self.count > 1 else ''}rows = {rows}" if self.in_file else ""
        samples = f"for {self.samples} samples{several}{where}"
        return (
            f'[[experiment]] "{self.experiment}", channel "{self.channel}": is exactly {self.value}, its {end} value, {samples}; '
            "elsewhere noise changes it with nearly every sample, as where a sensor is clipped at the end of its range, or stuck there"
        )


def clipped_outputs(data: DataSet, model: GreyBoxModel) -> Iterator[ClippedOutput]:
    """Of every output of every experiment, at values other than 0, which a speed that is computed from an encoder has at rest.

    Inputs may well be limited.
    """
    for recording in data.recordings:
        for output in model.outputs:
            if output.name not in recording.signals:
                continue
            values = recording.measured(output.name)
            known = np.flatnonzero(~np.isnan(values))
            for largest, plateaus in _plateaus(values[known]):
                rows = [(int(known[start]), int(known[stop - 1]) + 1) for start, stop in plateaus]
                yield _told(data, recording, output.name, largest, rows)


def _plateaus(values: NDArray[np.float64]) -> Iterator[tuple[bool, list[tuple[int, int]]]]:
    """For each end that values (N,) are clipped at, whether it is the upper one, and the samples [start, stop) of the plateaus."""
    if len(values) < 2:
        return
    runs = Runs.of(values)
    of_run = values[runs.starts]
    ends = {False: float(values.min()), True: float(values.max())}
    found = {
        largest: (of_run == end) & (runs.lengths >= _PLATEAU) for largest, end in ends.items() if _often(runs, end)
    }
    noise = noise_of(runs, np.isin(of_run, list(ends.values())) | (runs.lengths >= LONG)) if found else None
    # the range of a sensor ends where it measures, and not at an error code
    away = [float(values[at[0]]) for at in far_off(values)] if noise else []
    for largest, flat in found.items():
        pairs = zip(runs.starts[flat].tolist(), runs.lengths[flat].tolist(), strict=True)
        plateaus = [(start, start + length) for start, length in pairs]
        if noise is not None and ends[largest] not in away and any(noise.beside(*one) for one in plateaus):
            yield largest, plateaus


def _often(runs: Runs, end: float) -> bool:
    """Whether samples are exactly at that end of their range for long, or come back to it."""
    lengths = runs.lengths[(runs.values[runs.starts] == end) & (runs.lengths >= _PLATEAU)]
    back = len(lengths) >= _OFTEN and int(lengths.sum()) >= _SAMPLES
    return end != 0.0 and (back or bool(len(lengths) and lengths.max() >= LONG))


def _told(
    data: DataSet, recording: Recording, name: str, largest: bool, plateaus: list[tuple[int, int]]
) -> ClippedOutput:
    first, start = recording.rows[0], plateaus[0][0]
    longest = sorted(sorted(plateaus, key=lambda one: one[0] - one[1])[:_SHOWN])
    value = in_unit(f"{recording.signals[name][start]:.6g}", data.channels[name].unit or "")
    _, column = as_in_the_file(data, recording, name, start)
    marked = (
        "NaN in their place" if column is None else f"missing = {column[start]:.12g} in the channel's line on the card"
    )
    return ClippedOutput(
        recording.name,
        name,
        value,
        largest,
        sum(stop - begin for begin, stop in plateaus),
        len(plateaus),
        tuple((first + begin, first + stop) for begin, stop in longest),
        f"{marked}, which leaves them out of the comparison, unless it was measured so",
        rows_are_of_the_file(data),
    )
