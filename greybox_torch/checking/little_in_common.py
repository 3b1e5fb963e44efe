"""Files that are joined in time and have little of it in common, and counters that are read as time stamps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from greybox_torch.checking.joined_files import JoinedFiles
from greybox_torch.data import DataSet
from greybox_torch.data.card import card_at
from greybox_torch.data.checks import FEWEST_SAMPLES
from greybox_torch.data.clocks_written import in_clocks_to_fill_in
from greybox_torch.data.counts import counts_samples
from greybox_torch.data.data_warning import InASentence
from greybox_torch.data.holding_out import HELD_OUT
from greybox_torch.data.readers.table import Table

_LITTLE = 0.5
"""Share of the samples of an experiment, or of a joined file, below which a file has little in common with it."""


@dataclass(frozen=True)
class LittleInCommon(InASentence):
    """What a joined file has in common with the first, or which counter was taken for a time, and what to write instead."""

    found: str
    write: str


def little_in_common(joined: Mapping[str, JoinedFiles]) -> Iterator[LittleInCommon]:
    """Files within whose time less than half of an experiment lies, or of which only a few samples lie within the experiment."""
    for name, files in joined.items():
        if not (name.endswith(HELD_OUT) and name.removesuffix(HELD_OUT) in joined):
            yield from (told for table in files.source.joined if (told := _of_file(files, table)) is not None)


def _of_file(files: JoinedFiles, table: Table) -> LittleInCommon | None:
    time, stamps = files.time[slice(*files.rows)], table.columns[files.clock] * files.seconds
    first, other = files.source.tables[0].path.name, table.path.name
    covered = np.flatnonzero((time >= stamps[0]) & (time <= stamps[-1])) + files.rows[0]
    inside = int(((stamps >= time[0]) & (stamps <= time[-1])).sum())
    few = inside < FEWEST_SAMPLES and inside < _LITTLE * len(stamps)
    if len(covered) >= _LITTLE * len(time) and not few:
        return None
    columns = ", ".join(f'"{column}"' for column in table.columns if column != files.clock)
    lost = f"; what it has ({columns}) is missing in the others" if columns else ""
    found = (
        f"{inside} of the {len(stamps)} samples of {other} lie within the time of {first}"
        if few
        else f"{len(covered)} of {len(time)} samples lie within the time of {other}{lost}"
    )
    rows = (
        f"rows = [{covered[0]}, {covered[-1] + 1}], what they have in common"
        if len(covered)
        else "rows within its time"
    )
    clocks = in_clocks_to_fill_in(files.name_of(table), "unit", "offset")
    return LittleInCommon(
        f'[[experiment]] "{files.recording.name.removesuffix(HELD_OUT)}": {found}: {other} is from {stamps[0]:.6g} to {stamps[-1]:.6g} s, '
        f"the experiment from {time[0]:.6g} to {time[-1]:.6g} s",
        f"{clocks}, if the stamps of {other} are in another unit, or begin at another zero (offset: seconds to add); else {rows}",
    )


def counters_as_time(data: DataSet) -> Iterator[LittleInCommon]:
    """Columns of time stamps that are called as counters of samples, and count them."""
    card = card_at(data.path)
    seen: set[str] = set()
    if card is None:
        return
    for recording in data.recordings:
        entry = next((e for e in card.experiment if recording.name in (e.name, f"{e.name}{HELD_OUT}")), None)
        time = None if entry is None else card.of(entry).time
        if time is None or time.column in seen or not counts_samples(time.column, recording.time / time.seconds):
            continue
        seen.add(time.column)
        yield LittleInCommon(
            f'time: column "{time.column}" counts samples by its name and values, and is read as time stamps in {time.unit}',
            "another column, or sample_time = <seconds from one count to the next> in the place of time",
        )
