"""Encoders that begin anew after a turn: within one sample, the channel jumps by nearly all of its range while the machine moves on."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from greybox_torch.checking.overflowing_counters import Overflow, overflow_of
from greybox_torch.data import DataSet
from greybox_torch.data.card import read_card
from greybox_torch.data.card_channels import ChannelEntry
from greybox_torch.data.data_warning import InASentence
from greybox_torch.data.holding_out import HELD_OUT
from greybox_torch.data.units import conversion
from greybox_torch.data.unwrapping import TURNS, turn_within
from greybox_torch.errors import UserError
from greybox_torch.files import toml_key
from greybox_torch.in_unit import in_unit


@dataclass(frozen=True)
class WrappedChannel(InASentence):
    """``count`` jumps of a channel in an experiment, the first ``seconds`` after its start; ``period`` and ``unit`` are the channel's,
    ``counts`` those of its column that a counter of several turns overflows after.
    """

    experiment: str
    channel: str
    period: float
    unit: str
    count: int
    seconds: float
    write: str
    several: bool = False
    counts: float | None = None

    @property
    def found(self) -> str:
        """What is there, in a sentence."""
        times = "once" if self.count == 1 else f"{self.count} times"
        turn = in_unit(f"{self.period:.6g}", self.unit)
        if self.several:
            counts = "" if self.counts is None else f", {self.counts:.0f} counts of its column,"
            return (
                f'[[experiment]] "{self.experiment}", channel "{self.channel}": jumps by nearly {turn}{counts} within one sample {times}, '
                f"first {self.seconds:.6g} s after the start, as a counter does that overflows; no machine moves so"
            )
        return (
            f'[[experiment]] "{self.experiment}", channel "{self.channel}": jumps by nearly {turn} within one sample {times}, first '
            f"{self.seconds:.6g} s after the start, as an encoder does that begins anew after a turn; no machine moves so"
        )


def wrapped_channels(data: DataSet) -> Iterator[WrappedChannel]:
    """Of every experiment the channels that jump by a whole turn."""
    for recording in data.recordings:
        for name in recording.signals:
            values = recording.measured(name)
            unit = data.channels[name].unit
            known = np.flatnonzero(~np.isnan(values))
            period, jumps = turn_within(values[known], unit)
            overflow = None if len(jumps) else overflow_of(data, recording, name)
            if overflow is not None:
                period, jumps = overflow.period, overflow.jumps
            if len(jumps):
                seconds = float(recording.time[known[jumps[0] + 1]] - recording.time[0])
                write = _write(data, recording.name, name, period, overflow)
                counts = None if overflow is None else overflow.counts
                several = overflow is not None
                yield WrappedChannel(recording.name, name, period, unit, len(jumps), seconds, write, several, counts)


def _write(data: DataSet, experiment: str, name: str, period: float, overflow: Overflow | None) -> str:
    """What to write on the card, as far as there is one; else what to do with the array."""
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
    counted = overflow is not None and overflow.counts is not None
    call = overflow.call(entry) if overflow is not None and counted else _call(entry, period, factor, overflow)
    line = f"{toml_key(name)} = {{ expr = '{call}', … }}"
    if own:
        return (
            f"columns = {{ {line} }} in that experiment, which adds up the turns, with the rest of that entry as it is"
        )
    return f"{line}, which adds up the turns, with the rest of the line as it is"


def _call(entry: ChannelEntry, period: float, factor: float, overflow: Overflow | None) -> str:
    """The channel with ``period`` added up wherever it jumps, where a value of its column is ``factor`` in its unit."""
    column = entry.column or "column"
    source = entry.expr or (column if column.isidentifier() else f'col("{column}")')
    call, turn = f"unwrap({source}, {_number(period / abs(factor))})", TURNS.get(entry.unit, 0.0)
    # Counts, or another unit, were taken for angles.
    if overflow is None and turn and factor == 1.0 and not math.isclose(turn, period, rel_tol=1e-6):
        call += f" * {_number(turn)} / {_number(period)}"
    return call


def _number(period: float) -> str:
    """A period as one would write it."""
    halves = round(period / math.pi)
    if halves and halves % 2 == 0 and math.isclose(period, halves * math.pi, rel_tol=1e-6):
        return f"{halves} * pi"
    near = round(period)
    return str(near) if near and math.isclose(period, near, rel_tol=1e-6) else f"{period:.10g}"
