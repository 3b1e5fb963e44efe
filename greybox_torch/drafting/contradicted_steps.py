"""A sample time on the card that a column of time stamps beside the channels contradicts."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data import DataSet
from greybox_torch.data.card import card_at
from greybox_torch.data.card_channels import ExperimentEntry
from greybox_torch.data.column_units import without_ending
from greybox_torch.data.columns import columns_of
from greybox_torch.data.counts import named_as_counter
from greybox_torch.data.data_warning import InASentence
from greybox_torch.data.gaps import Gap, longest_gap, pieces_around
from greybox_torch.data.readers import read_table
from greybox_torch.data.readers.table import Table
from greybox_torch.data.units import conversion
from greybox_torch.drafting.clock import is_clock, named_like_a_clock
from greybox_torch.drafting.contradicted import time_in
from greybox_torch.errors import UserError
from greybox_torch.files import toml_text

_SAME = 0.02
"""Share by which steps may differ from the sample time: stamps are rounded, and a few samples may be lost."""
_UNITS = ("s", "ms", "us", "ns", "min", "h")


@dataclass(frozen=True)
class ContradictedSteps(InASentence):
    """``step`` is the usual one of the stamps in ``unit``, which is empty where nothing says it; ``sample_time`` the card's, in s."""

    file: str
    column: str
    step: float
    unit: str
    sample_time: float

    @property
    def found(self) -> str:
        """What is there, in a sentence."""
        steps = f"{self.step:.6g} {self.unit}".rstrip()
        return f'sample_time: column "{self.column}" of {self.file} has steps of {steps}, but the card says {self.sample_time:.6g} s'

    @property
    def write(self) -> str:
        """What to write instead."""
        time = f"time = {_time_entry(self.column, self.unit)} in its place"
        if self.unit in ("", "s"):
            doubt = "" if self.unit else ", if the stamps are in s"
            return f"{time}, or sample_time = {self.step:.6g}{doubt}"
        return time


@dataclass(frozen=True)
class ClosedGap(InASentence):
    """A gap in time stamps, which samples that are counted by a sample time leave out."""

    file: str
    column: str
    unit: str
    gap: Gap
    rows: tuple[int, int] | None
    """Those of the experiment; None where several files follow each other in it."""

    @property
    def found(self) -> str:
        """What is there, in a sentence."""
        counted = "samples that are counted run on there as if none were missing"
        return f'sample_time: column "{self.column}" of {self.file} has a {self.gap}; {counted}'

    @property
    def write(self) -> str:
        """What to write instead."""
        split = self.gap.after + 1
        pieces = "" if self.rows is None else f"; or {pieces_around((split, split), self.rows)}"
        return f"time = {_time_entry(self.column, self.unit)} in its place{pieces}"


def contradicted_steps(data: DataSet) -> Iterator[ContradictedSteps | ClosedGap]:
    """The first file whose stamps say another sample time than the card, or have a gap within an experiment; none where the card names its
    time stamps.
    """
    card = card_at(data.path)
    if card is None or data.path is None or card.time is not None or card.sample_time is None:
        return
    experiments: dict[Path, list[ExperimentEntry]] = {}
    for entry in card.experiment:
        for name in entry.file:
            experiments.setdefault(data.path.parent / name, []).append(entry)
    for file, entries in experiments.items():
        taken = {column for entry in entries for formula in card.formulas(entry).values() for column in formula.columns}
        told = _told(file, card.sample_time, entries, taken)
        if told is not None:
            yield told
            return


def _told(
    file: Path, sample_time: float, entries: Sequence[ExperimentEntry], taken: Collection[str]
) -> ContradictedSteps | ClosedGap | None:
    """``taken`` are the columns that channels are made of. The first column of a file may be its time stamps whatever it is called, if it
    has a unit of time.
    """
    try:
        names = columns_of(file).names
    except UserError:  # a format that cannot list its columns
        return None
    first = [name for name in names[:1] if name not in taken and not named_as_counter(without_ending(name))]
    for name in dict.fromkeys([*filter(named_like_a_clock, names), *first]):
        try:
            table = read_table(file, (name,))
        except UserError:  # a column of text
            continue
        stamps = table.columns[name]
        if not is_clock(stamps, gaps=False):
            continue
        steps = np.diff(stamps)
        usual, unit = float(np.median(steps)), _unit(table, name)
        if not (unit or named_like_a_clock(name)):
            continue
        if not unit and usual == 1.0:  # counts samples
            return None
        seconds = {one: conversion(one, "s", "")[0] for one in ((unit,) if unit else _UNITS)}
        mean = float(steps.mean())
        same = [u for u, s in seconds.items() if any(abs(one * s / sample_time - 1.0) < _SAME for one in (usual, mean))]
        if not same:
            return ContradictedSteps(file.name, name, usual, unit, sample_time)
        gaps = (_gap_within(stamps * seconds[same[0]], entry) for entry in entries)
        return next((ClosedGap(file.name, name, same[0], *found) for found in gaps if found is not None), None)
    return None


def _gap_within(stamps: NDArray[np.float64], entry: ExperimentEntry) -> tuple[Gap, tuple[int, int] | None] | None:
    """The longest gap of a file's stamps (N,), in s, within an experiment, and its rows. Those of files that follow each other are not
    the file's.
    """
    counted = entry.join != "concatenate"
    start, stop = (counted and entry.rows) or (0, len(stamps))
    gap = longest_gap(stamps[start:stop])
    if gap is None or gap.of_summer_time:
        return None
    return replace(gap, after=start + gap.after, start=float(stamps[0])), (start, stop) if counted else None


def _time_entry(column: str, unit: str) -> str:
    text = toml_text(column)
    return text if unit in ("", "s") else f"{{ column = {text}, unit = {toml_text(unit)} }}"


def _unit(table: Table, column: str) -> str:
    """The unit of time stamps that the file says, or else their name."""
    return time_in(f"[{table.units.get(column, '').strip('[]() ')}]") or time_in(column)
