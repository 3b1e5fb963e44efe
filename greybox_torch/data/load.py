"""From a card to a data set: reads the files that it names, and checks what it reads."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.card import TIME, Card, ExperimentEntry, read_card
from greybox_torch.data.dataset import DataSet, hash_of
from greybox_torch.data.readers import read_table
from greybox_torch.data.readers.table import Table
from greybox_torch.data.recording import Channel, Recording
from greybox_torch.errors import UserError

FEWEST_SAMPLES = 10


def load_dataset(path: str | PathLike[str]) -> DataSet:
    """The data set described by the card at `path` (`dataset.toml`), with all of its recordings read and checked.

    Values are scaled to the channels' units and missing samples are NaN. Where the card gives no experiment the role
    "validation", the last quarter of each becomes a recording "<name> (held out)" with that role. Raises UserError,
    with one message that names the file and the field, line or sample, for whatever is wrong in card or recordings.
    """
    path = Path(path)
    card = read_card(path)
    read = cache(read_table)  # experiments are often slices of one file
    recordings = tuple(_read_recording(path, card, experiment, read) for experiment in card.experiment)
    hold_out = all(recording.role != "validation" for recording in recordings)
    if hold_out:
        recordings = tuple(part for recording in recordings for part in _hold_out_last_quarter(recording))
    for recording in recordings:
        _check_not_all_missing(path, recording)
    return DataSet(
        name=card.name or path.resolve().parent.name,
        path=path,
        hold=card.hold,
        channels={name: Channel(name, entry.unit) for name, entry in card.channels.items()},
        recordings=recordings,
        model=_absolute_model(card.model.name, path),
        parameters=card.model.parameters,
        initial=card.model.initial,
        held_out_by_default=hold_out,
        sha256=hash_of(recordings),
    )


def _read_recording(path: Path, card: Card, experiment: ExperimentEntry, read: Callable[..., Table]) -> Recording:
    file = path.parent / experiment.file
    columns = {name: experiment.columns.get(name, entry.column) for name, entry in card.channels.items()}
    if card.time is not None:
        columns[TIME] = experiment.columns.get(TIME, card.time)
    table = read(file, tuple(dict.fromkeys(columns.values())))
    place = f'{path}, [[experiment]] "{experiment.name}"'
    start, stop = _rows(place, table, experiment.rows)
    if stop - start < FEWEST_SAMPLES:
        raise UserError(f"{place}: has {stop - start} samples; expected at least {FEWEST_SAMPLES}")
    if card.sample_time is None:
        time = _time_stamps(table, columns.pop(TIME), start, stop)
        sample_time = float(np.median(np.diff(time)))
    else:
        time = np.arange(start, stop, dtype=np.float64) * card.sample_time
        sample_time = card.sample_time
    return Recording(
        name=experiment.name,
        role=experiment.role,
        time=time,
        sample_time=sample_time,
        signals={
            name: _signal(table, column, start, stop) * card.channels[name].scale for name, column in columns.items()
        },
        source=file,
        rows=(start, stop),
    )


def _rows(place: str, table: Table, rows: list[int] | None) -> tuple[int, int]:
    """The slice of the file's samples that an experiment stands for."""
    lengths = {column: len(values) for column, values in table.columns.items()}
    if len(set(lengths.values())) > 1:
        found = ", ".join(f'"{column}" has {length}' for column, length in lengths.items())
        raise UserError(f"{table.path}: columns differ in length: {found}; expected as many samples in each")
    (length,) = set(lengths.values())
    start, stop = rows or (0, length)
    if rows and not 0 <= start < stop <= length:
        raise UserError(
            f"{place}, rows: found [{start}, {stop}], expected 0 <= start < stop <= {length}, "
            f"the number of samples in {table.path}"
        )
    return start, stop


def _time_stamps(table: Table, column: str, start: int, stop: int) -> NDArray[np.float64]:
    time = _signal(table, column, start, stop)
    missing = np.flatnonzero(np.isnan(time))
    if missing.size:
        raise UserError(f"{table.place(column, start + missing[0])}: the time stamp is missing; expected a number")
    steps = np.diff(time)
    backward = np.flatnonzero(steps <= 0)
    if backward.size:
        later = backward[0] + 1
        raise UserError(
            f"{table.place(column, start + later)}: found {time[later]:.9g} s after {time[later - 1]:.9g} s; "
            "expected time stamps that increase from sample to sample"
        )
    return time


def _signal(table: Table, column: str, start: int, stop: int) -> NDArray[np.float64]:
    values = table.columns[column][start:stop]
    infinite = np.flatnonzero(np.isinf(values))
    if infinite.size:
        raise UserError(
            f"{table.place(column, start + infinite[0])}: found {values[infinite[0]]:g}, expected a finite number "
            "(NaN where the sample is missing)"
        )
    return values


def _hold_out_last_quarter(recording: Recording) -> tuple[Recording, Recording]:
    split = len(recording) - len(recording) // 4
    return (
        recording.part(0, split),
        recording.part(split, len(recording), name=f"{recording.name} (held out)", role="validation"),
    )


def _check_not_all_missing(path: Path, recording: Recording) -> None:
    for channel, values in recording.signals.items():
        if np.isnan(values).all():
            raise UserError(
                f'{path}, [[experiment]] "{recording.name}", channel "{channel}": all {len(values)} samples are '
                f"missing (NaN) in {recording.source}, rows {list(recording.rows)}; expected numbers"
            )


def _absolute_model(name: str | None, path: Path) -> str | None:
    """ "my_motor.py:Motor" with the file relative to the card made absolute; the name of a built-in system as it is."""
    if name is None:
        return None
    file, colon, model_class = name.rpartition(":")
    if not file.endswith(".py"):
        return name
    return f"{(path.parent / file).resolve()}{colon}{model_class}"
