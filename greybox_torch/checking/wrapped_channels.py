"""Encoders that begin anew after a turn: within one sample, the channel jumps by nearly all of its range while the machine moves on."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from greybox_torch.checking.joined_files import JoinedFiles
from greybox_torch.data import DataSet
from greybox_torch.data.card import read_card
from greybox_torch.data.data_warning import InASentence
from greybox_torch.data.holding_out import HELD_OUT
from greybox_torch.data.units import conversion
from greybox_torch.data.unwrapping import TURNS, turn_within
from greybox_torch.errors import UserError
from greybox_torch.files import toml_key
from greybox_torch.in_unit import in_unit

IN_THE_FILE = (
    "the turns added up in the file that is joined (numpy.unwrap of the column, with period = a whole turn), or that file first in "
    "file = […]; unwrap() on the card comes too late, as straight lines between that file's samples cross each jump"
)
"""What to do with a slower file of join = "time": its column is on the time stamps of the first before an expression sees it."""


@dataclass(frozen=True)
class WrappedChannel(InASentence):
    """``count`` jumps of a channel in an experiment, the first ``seconds`` after its start; ``period`` and ``unit`` are the channel's."""

    experiment: str
    channel: str
    period: float
    unit: str
    count: int
    seconds: float
    write: str

    @property
    def found(self) -> str:
        """What is there, in a sentence."""
        times = "once" if self.count == 1 else f"{self.count} times"
        turn = in_unit(f"{self.period:.6g}", self.unit)
        return (
            f'[[experiment]] "{self.experiment}", channel "{self.channel}": jumps by nearly {turn} within one sample {times}, first '
            f"{self.seconds:.6g} s after the start, as an encoder does that begins anew after a turn; no machine moves so"
        )


def wrapped_channels(data: DataSet, joined: Mapping[str, JoinedFiles] | None = None) -> Iterator[WrappedChannel]:
    """Of every experiment the channels that jump by a whole turn.

    Args:
        joined: by recording, the files that were joined in time.
    """
    for recording in data.recordings:
        for name in recording.signals:
            values = recording.measured(name)
            unit = data.channels[name].unit
            known = np.flatnonzero(~np.isnan(values))
            period, jumps = turn_within(values[known], unit)
            if len(jumps):
                seconds = float(recording.time[known[jumps[0] + 1]] - recording.time[0])
                files = None if joined is None else joined.get(recording.name)
                of_first = files is not None and files.columns.get(name) in files.source.tables[0].columns
                slower = name in recording.between and not of_first
                write = _write(data, recording.name, name, period, joined=slower)
                yield WrappedChannel(recording.name, name, period, unit, len(jumps), seconds, write)


def _write(data: DataSet, experiment: str, name: str, period: float, *, joined: bool) -> str:
    """What to write on the card, as far as there is one; else what to do with the array.

    Args:
        joined: whether the channel may run on straight lines between the samples of a slower file. A slower column of the first file does
            so only behind its expression.
    """
    try:
        card = None if data.path is None else read_card(data.path)
        here = [e for e in card.experiment if e.name == experiment.removesuffix(HELD_OUT)] if card else []
        own = any(name in e.columns for e in here)
        entry = card.of(here[0]).channels.get(name) if card and here else None
        if entry is None or entry.derivative is not None:
            return f"the turns added up: numpy.unwrap(values, period={_number(period)})"
        factor = entry.scale if entry.file_unit is None else conversion(entry.file_unit, entry.unit, "")[0]
    except UserError:  # the card was replaced meanwhile
        return "the turns added up: expr = 'unwrap(column, period)'"
    if here[0].join == "time" and joined:
        return IN_THE_FILE
    column = entry.column or "column"
    source = entry.expr or (column if column.isidentifier() else f'col("{column}")')
    call, turn = f"unwrap({source}, {_number(period / abs(factor))})", TURNS.get(entry.unit, 0.0)
    # Counts, or another unit, were taken for angles.
    if turn and factor == 1.0 and not math.isclose(turn, period, rel_tol=1e-6):
        call += f" * {_number(turn)} / {_number(period)}"
    line = f"{toml_key(name)} = {{ expr = '{call}', … }}"
    if own:
        return (
            f"columns = {{ {line} }} in that experiment, which adds up the turns, with the rest of that entry as it is"
        )
    return f"{line}, which adds up the turns, with the rest of the line as it is"


def _number(period: float) -> str:
    """A period as one would write it."""
    if math.isclose(period, 2.0 * math.pi, rel_tol=1e-6):
        return "2 * pi"
    near = round(period)
    return str(near) if near and math.isclose(period, near, rel_tol=1e-6) else f"{period:.10g}"
