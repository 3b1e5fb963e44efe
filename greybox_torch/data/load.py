"""From a card to a data set: reads the files that it names, and checks what it reads."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.asked_for import asked_for
from greybox_torch.data.card import Card, read_card
from greybox_torch.data.card_channels import ChannelEntry, ExperimentEntry
from greybox_torch.data.card_constants import constants_of, told_constants
from greybox_torch.data.checks import check_finite, check_length, check_time
from greybox_torch.data.column_units import unit_in
from greybox_torch.data.common_time import check_common_time
from greybox_torch.data.dataset import DataSet
from greybox_torch.data.error_values import without_error_values
from greybox_torch.data.expression import Expression, turns_of
from greybox_torch.data.file_clocks import with_clocks
from greybox_torch.data.file_units import check_unit_of_time, check_units, factor_of, in_unit
from greybox_torch.data.gaps import longest_gap, without_gaps
from greybox_torch.data.missing import where_missing
from greybox_torch.data.model_of_card import absolute_model
from greybox_torch.data.processing import at_times, decimated, derivative, even_grid
from greybox_torch.data.readers import read_table
from greybox_torch.data.recording import Channel, Recording
from greybox_torch.data.slower_columns import between_of, slower_column
from greybox_torch.data.source import Read, Source, source_of
from greybox_torch.data.steps import EVEN, even_step, unevenness, usual_step
from greybox_torch.errors import UserError
from greybox_torch.files import absolute


def load_dataset(path: str | PathLike[str]) -> DataSet:
    """The data set described by the card at `path` (`dataset.toml`), with all of its recordings read and checked.

    Values are scaled to the channels' units and missing samples are NaN. Where the card gives no experiment the role
    "validation", the last quarter of each becomes a recording "<name> (held out)" with that role. Raises UserError,
    with one message that names the file and the field, line or sample, for whatever is wrong in card or recordings.
    """
    return dataset_of(read_card(Path(path)), Path(path))


def dataset_of(card: Card, path: Path) -> DataSet:
    """The data set of a card that stands at `path`, or would. Raises UserError as :func:`load_dataset` does."""
    read = cache(read_table)  # experiments are often slices of one file
    return DataSet(
        [_read_recording(path, card.of(experiment), experiment, read) for experiment in card.experiment],
        hold=card.hold,
        name=card.name or absolute(path).parent.name or "recordings",
        path=path,
        channels={name: _channel(name, entry) for name, entry in card.channels.items()},
        model=absolute_model(card.model.name, path),
        parameters=card.model.parameters,
        initial=card.model.initial,
        diagnosis=card.diagnosis,
        limits=card.limits,
        controller=card.controller,
        beliefs=card.beliefs,
    )


def _channel(name: str, entry: ChannelEntry) -> Channel:
    column = entry.column or ""
    plain = (
        entry.derivative is None and "scale" not in entry.model_fields_set
    )  # else the name tells the unit of something else
    return Channel(name, entry.unit, column, entry.file_unit or (unit_in(column) if plain else ""), factor_of(entry))


def _read_recording(path: Path, card: Card, experiment: ExperimentEntry, read: Read) -> Recording:
    """``card`` as it is for the experiment."""
    place = f'{path}, [[experiment]] "{experiment.name}"'
    files = [path.parent / file for file in experiment.file]
    clock = None if card.time is None else card.time.column
    formulas = card.formulas(experiment)
    clocks = [column for column in (clock, card.time.date if card.time else None) if column]
    needed = [*(c for formula in formulas.values() for c in formula.columns), *clocks[:1]]
    others = [path.parent / file for other in card.experiment if other is not experiment for file in other.file[:1]]
    with asked_for(place, formulas, clocks, others, read):
        dated = with_clocks(files, experiment, card.time, read)
        known = without_error_values(dated, card.channels, formulas)
        turns = turns_of(formulas.values())
        source = source_of(files, experiment.join, list(dict.fromkeys(needed)), clock, known, turns)
    start, stop = _rows(place, source, experiment.rows)
    check_length(stop - start, place)
    time, sample_time = _time(place, path, card, source, clock, start, stop, experiment.file)
    check_common_time(place, experiment, card.time, source, (start, stop))
    check_units(place, card.channels, formulas, source, experiment.columns)
    signals = {
        name: _signal(f'{place}, channel "{name}"', card.channels[name], formula, source, start, stop)
        for name, formula in formulas.items()
    }
    slow = {name: found for name, values in signals.items() if (found := slower_column(name, time, values))}
    recorded = signals = signals | {name: found.values for name, found in slow.items()}

    def missing(name: str, at: float) -> str:
        near = int(np.searchsorted(time, at))
        return where_missing(source, clock, formulas[name], recorded[name], (start, stop), near)

    done = _processed(place, card, time, sample_time, signals, missing)
    check_length(len(done.time), place)
    constants = constants_of(place, experiment, len(done.time))
    own = {name: found.between for name, found in slow.items()}
    between = between_of(source, formulas, (start, stop)) | own if np.array_equal(done.time, time) else {}
    slower = f"slower than the rest, an output among them counts at its own samples alone: {', '.join(between)}"
    return Recording(
        name=experiment.name,
        role=experiment.role,
        time=done.time,
        sample_time=done.sample_time,
        signals={name: constants[name] if name in constants else done.signals[name] for name in card.channels},
        source=files[0],
        further=tuple(files[1:]),
        rows=(start, stop) if len(done.time) == stop - start else (0, len(done.time)),
        units={name: entry.unit for name, entry in card.channels.items()},
        notes=(
            *source.notes,
            *done.notes,
            *(found.note for found in slow.values()),
            *([slower] if between else []),
            *told_constants(card.channels, experiment),
        ),
        between=between,
        constants=frozenset(constants),
    )


def _rows(place: str, source: Source, rows: list[int] | None) -> tuple[int, int]:
    """The slice of the file's samples that an experiment stands for."""
    length = len(next(iter(source.columns.values())))
    start, stop = rows or (0, length)
    if rows and length == 0:
        raise UserError(
            f"{source.tables[0].path}: has no samples; expected lines of numbers below its header ({place})"
        )
    if rows and not 0 <= start < stop <= length:
        raise UserError(
            f"{place}, rows: found [{start}, {stop}], expected 0 <= start < stop <= {length}, "
            f"the number of samples in {source.tables[0].path}"
        )
    return start, stop


def _time(
    place: str, path: Path, card: Card, source: Source, clock: str | None, start: int, stop: int, files: list[str]
) -> tuple[NDArray[np.float64], float]:
    """Time stamps (N,) and the usual step, in seconds."""
    if card.time is None or clock is None:
        step = card.sample_time or 1.0
        with np.errstate(over="ignore"):
            time = np.arange(start, stop, dtype=np.float64) * step
        if not np.isfinite(time[-1]) or time[-1] <= time[0]:
            raise UserError(
                f"{path}: sample_time: {step:g} s makes times that are no numbers; expected seconds between samples"
            )
        return time, step
    check_unit_of_time(path, card.time, source, clock, files)
    time = source.columns[clock][start:stop]
    time = time if card.time.unit == "s" else time * card.time.seconds
    check_time(time, lambda sample: f"{place}: {source.place(clock, start + sample)}")
    return time, usual_step(time)


def _signal(
    place: str, entry: ChannelEntry, formula: Expression, source: Source, start: int, stop: int
) -> NDArray[np.float64]:
    """A channel's samples in its unit."""
    columns = {column: source.columns[column][start:stop] for column in formula.columns}
    for column, values in columns.items():
        check_finite(values, lambda sample, column=column: f"{place}: {source.place(column, start + sample)}")
    values = formula.of(columns)
    lost = np.isnan(values) & ~np.any([np.isnan(column) for column in columns.values()], axis=0)
    if lost.any():
        raise UserError(f'{place}: "{formula.text}" is no number at sample {int(np.argmax(lost))} (the first is 0)')
    with np.errstate(over="ignore"):
        values = in_unit(entry, values)
    check_finite(values, lambda sample: f"{place}, sample {sample} (the first is 0), once scaled")
    return values


class _Processed:
    """The samples of an experiment, and what was done to them."""

    def __init__(self, time: NDArray[np.float64], sample_time: float, signals: dict[str, NDArray[np.float64]]) -> None:
        self.time, self.sample_time, self.signals = time, sample_time, signals
        self.notes: list[str] = []


def _processed(
    place: str,
    card: Card,
    time: NDArray[np.float64],
    sample_time: float,
    signals: dict[str, NDArray[np.float64]],
    missing: Callable[[str, float], str],
) -> _Processed:
    """Resampled, differentiated and decimated, as far as the card asks for it. `missing` says where a channel's sample is missing."""
    done = _Processed(time, sample_time, signals)
    jitter = 0.0 if card.time is None else unevenness(time)
    if jitter > EVEN:
        steps, gap = without_gaps(time), longest_gap(time)
        if gap is not None and card.resample is not None:
            done.notes.append(f"{gap}, filled with straight lines by resample")
        if (
            unevenness(time, gaps=False, lost=card.resample is not None) > EVEN
        ):  # lost samples are a warning of their own
            done.notes.append(
                f"time stamps are uneven: steps between {steps.min():.6g} and {steps.max():.6g} s, median {sample_time:.6g} s"
                + ("" if card.resample else f"; resample = {even_step(time)} at the top of the card makes them even")
            )
    if card.resample is not None:
        done.time, done.sample_time = even_grid(time, card.resample, place), card.resample
        done.signals = {name: at_times(done.time, time, values) for name, values in signals.items()}
        done.notes.append(f"resampled to steps of {card.resample:g} s, on straight lines between samples")
    of_column = {name: entry for name, entry in card.channels.items() if name in signals}
    rates = {name: entry.derivative for name, entry in of_column.items() if entry.derivative is not None}
    if (rates or card.decimate) and card.resample is None and jitter > EVEN:
        gap = longest_gap(time)
        found = (
            ""
            if gap is None
            else f" ({gap}; better: one experiment before it and another after it, each with its rows)"
        )
        raise UserError(
            f"{place}: derivative and decimate need even time stamps; expected resample = <seconds> as well{found}"
        )
    for name, cutoff in rates.items():
        done.signals[name] = derivative(
            done.signals[name],
            done.sample_time,
            cutoff,
            f'{place}, channel "{name}", derivative',
            lambda sample, name=name: missing(name, done.time[sample]),
        )
        done.notes.append(f"{name} is the rate of change of the recorded samples behind a low pass at {cutoff:g} Hz")
    if card.decimate is not None:
        done.signals = {name: decimated(values, card.decimate) for name, values in done.signals.items()}
        done.time, done.sample_time = done.time[:: card.decimate], done.sample_time * card.decimate
        done.notes.append(f"one of {card.decimate} samples kept, behind a low pass against aliasing")
    return done
