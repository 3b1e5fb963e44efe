"""Where a sample of a recording stands in its file, and the samples as the file has them, before any conversion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data import DataSet, Recording
from greybox_torch.data.card import read_card
from greybox_torch.data.error_values import without_error_values
from greybox_torch.data.file_clocks import with_clocks
from greybox_torch.data.holding_out import HELD_OUT
from greybox_torch.data.readers import read_table
from greybox_torch.data.source import source_of
from greybox_torch.errors import UserError


def rows_on_the_card(data: DataSet, recording: Recording) -> tuple[int, int]:
    """The rows of the experiment that the card has, where its last quarter was held out as a recording of its own."""
    if not data.held_out_by_default:
        return recording.rows
    place = data.recordings.index(recording)
    first = place - place % 2  # two parts of every experiment, one after the other
    return data.recordings[first].rows[0], data.recordings[first + 1].rows[1]


def rows_are_of_the_file(data: DataSet) -> bool:
    """Whether a recording's rows are rows of its file: not where the card resamples, or leaves samples out."""
    if data.path is None:
        return True
    card = read_card(data.path)
    return not (card.decimate or card.resample)


def as_in_the_file(
    data: DataSet, recording: Recording, name: str, sample: int
) -> tuple[str, NDArray[np.float64] | None]:
    """Where a sample of the channel ``name`` stands, and its samples (N,) as the file has them; None where it is not a column of one."""
    try:
        found = _in_its_file(data, recording, name, sample)
    except (UserError, KeyError):  # the card or the file was replaced meanwhile
        found = None
    return found or (f"sample {sample} (the first is 0)", None)


def _in_its_file(data: DataSet, recording: Recording, name: str, sample: int) -> tuple[str, NDArray[np.float64]] | None:
    if data.path is None or recording.source is None:
        return None
    card = read_card(data.path)
    said = {f"{entry.name}{end}": entry for entry in card.experiment for end in ("", HELD_OUT)}.get(recording.name)
    if said is None or card.decimate or card.resample or card.channels[name].derivative:
        return None
    card = card.of(said)
    formula = card.formulas(said).get(name)
    if formula is None or len(formula.columns) != 1:
        return None
    columns = formula.columns
    clock = card.time.column if card.time else None
    needed = [*columns, clock] if clock and said.join == "time" and clock not in columns else columns
    files = [data.path.parent / file for file in said.file]
    dated = with_clocks(files, said, card.time, read_table)
    read = without_error_values(dated, card.channels, {name: formula})
    source = source_of(files, said.join, needed, clock, read)
    start, stop = recording.rows
    values = source.columns[columns[0]][start:stop]
    return (source.place(columns[0], start + sample), values) if len(values) == len(recording.time) else None
