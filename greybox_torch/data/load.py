"""From a card to a data set: reads the files that it names, and checks what it reads."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.card import TIME, Card, ExperimentEntry, read_card
from greybox_torch.data.checks import check_finite, check_length, check_time
from greybox_torch.data.dataset import DataSet
from greybox_torch.data.readers import read_table
from greybox_torch.data.readers.table import Table
from greybox_torch.data.recording import Channel, Recording
from greybox_torch.errors import UserError


def load_dataset(path: str | PathLike[str]) -> DataSet:
    """The data set described by the card at `path` (`dataset.toml`), with all of its recordings read and checked.

    Values are scaled to the channels' units and missing samples are NaN. Where the card gives no experiment the role
    "validation", the last quarter of each becomes a recording "<name> (held out)" with that role. Raises UserError,
    with one message that names the file and the field, line or sample, for whatever is wrong in card or recordings.
    """
    path = Path(path)
    card = read_card(path)
    read = cache(read_table)  # experiments are often slices of one file
    return DataSet(
        [_read_recording(path, card, experiment, read) for experiment in card.experiment],
        hold=card.hold,
        name=card.name or path.resolve().parent.name or "recordings",
        path=path,
        channels={name: Channel(name, entry.unit) for name, entry in card.channels.items()},
        model=_absolute_model(card.model.name, path),
        parameters=card.model.parameters,
        initial=card.model.initial,
    )


def _read_recording(path: Path, card: Card, experiment: ExperimentEntry, read: Callable[..., Table]) -> Recording:
    file = path.parent / experiment.file
    columns = {name: experiment.columns.get(name, entry.column) for name, entry in card.channels.items()}
    if card.time is not None:
        columns[TIME] = experiment.columns.get(TIME, card.time)
    table = read(file, tuple(dict.fromkeys(columns.values())))
    place = f'{path}, [[experiment]] "{experiment.name}"'
    start, stop = _rows(place, table, experiment.rows)
    check_length(stop - start, place)
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
        units={name: entry.unit for name, entry in card.channels.items()},
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
    time = table.columns[column][start:stop]
    check_time(time, lambda sample: table.place(column, start + sample))
    return time


def _signal(table: Table, column: str, start: int, stop: int) -> NDArray[np.float64]:
    values = table.columns[column][start:stop]
    check_finite(values, lambda sample: table.place(column, start + sample))
    return values


def _absolute_model(name: str | None, path: Path) -> str | None:
    """ "my_motor.py:Motor" with the file relative to the card made absolute; the name of a built-in system as it is."""
    if name is None:
        return None
    file, colon, model_class = name.rpartition(":")
    if not file.endswith(".py"):
        return name
    return f"{(path.parent / file).resolve()}{colon}{model_class}"
