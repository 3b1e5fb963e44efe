"""Time stamps that lead astray: gaps and lost samples, across which a simulation has to run blind, and files in different units of time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from greybox_torch.checking.as_in_the_file import rows_on_the_card
from greybox_torch.checking.joined_files import JoinedFiles
from greybox_torch.data import DataSet, Recording
from greybox_torch.data.card import card_at
from greybox_torch.data.card_channels import TimeEntry
from greybox_torch.data.data_warning import InASentence
from greybox_torch.data.gaps import Gap, Lost, longest_gap, lost_samples, pieces_around
from greybox_torch.data.holding_out import HELD_OUT
from greybox_torch.data.readers.table import Table
from greybox_torch.data.steps import even_step
from greybox_torch.data.summer_time import instead_of_summer_time
from greybox_torch.files import toml_text
from greybox_torch.name_lists import listed

_SHOWN = 3  # places at which samples were lost
_PREFIXED = ("s", "ms", "us", "ns")  # a thousand of each are one before
_SAME = 0.01  # of a sample time: how far a ratio may lie from a power of 1000


@dataclass(frozen=True)
class OddTime(InASentence):
    """What is odd about an experiment's time stamps, and what to write instead, in a sentence each."""

    found: str
    write: str


def odd_time_stamps(data: DataSet, joined: Mapping[str, JoinedFiles]) -> Iterator[OddTime]:
    """Gaps in the time stamps, also in those of files that are joined in time (``joined``, by recording), single samples that are missing,
    and experiments whose sample times differ by a thousand, as seconds and milliseconds do.
    """
    for recording in data.recordings:
        gap = longest_gap(recording.time)
        if gap is not None:
            yield _gap(recording, gap, rows_on_the_card(data, recording))
    of_step: dict[str, list[tuple[Recording, tuple[Lost, ...]]]] = {}
    for recording in data.recordings:
        if lost := lost_samples(recording.time):
            of_step.setdefault(even_step(recording.time), []).append((recording, lost))
    yield from (_lost(step, losing) for step, losing in of_step.items())
    for name, files in joined.items():
        held_out = joined.get(f"{name}{HELD_OUT}") if data.held_out_by_default else None
        for table in files.source.joined:
            gap = files.longest_gap(table, np.inf if held_out is None else held_out.recording.time[0])
            if gap is not None:
                yield _gap_of_joined(files, table, gap)
    whole = [
        recording for recording in data.recordings if not (data.held_out_by_default and recording.role == "validation")
    ]
    first = min(whole, key=lambda recording: recording.sample_time, default=None)
    slower = [r for r in whole if first is not None and _thousands(r.sample_time / first.sample_time)]
    clocks = _clocks(data) if slower else {}
    of_write = {(odd := _unit(r, first, clocks)).write: odd for r in reversed(slower) if first is not None}
    yield from reversed(of_write.values())


def _gap(recording: Recording, gap: Gap, rows: tuple[int, int]) -> OddTime:
    """``rows`` and what is written are rows of the file."""
    start, stop = rows
    split = recording.rows[0] + gap.after + 1
    if gap.of_summer_time:
        return OddTime(
            f'[[experiment]] "{recording.name}": {gap}, as where local time is set to summer time; then nothing is missing',
            f"{instead_of_summer_time(gap.step)}; if samples are missing, two experiments: rows = [{start}, {split}] and "
            f"rows = [{split}, {stop}]",
        )
    return OddTime(
        f'[[experiment]] "{recording.name}": {gap}; a simulation across it would hold the last input for all that time',
        f"two experiments with the same file, one before the gap and one after it: rows = [{start}, {split}] and rows = [{split}, {stop}]",
    )


def _lost(step: str, losing: Sequence[tuple[Recording, tuple[Lost, ...]]]) -> OddTime:
    """Experiments of one ``step`` in one warning, the first ones with up to a few places; what is written are samples of the file."""
    shown, others = losing[:_SHOWN], len(losing) - _SHOWN
    found = "; ".join(f'"{recording.name}": {_places(lost)}' for recording, lost in shown)
    more = f"; and {others} more experiment{'s' if others > 1 else ''}" if others > 0 else ""
    pieces = [f"{_beginnings(*one)} of {_file(one[0], alone=not losing[1:])}" for one in shown]
    return OddTime(
        f"[[experiment]] {found} (from the start){more}, as where messages were lost; what drove the machine there is not known, which "
        "under feedback may be much of a free run's error",
        f"resample = {step} at the top of the card, which fills them with straight lines; or an experiment for each piece between them "
        f"(pieces begin with the rows {'; '.join(pieces)})",
    )


def _places(lost: tuple[Lost, ...]) -> str:
    total, shown = sum(one.count for one in lost), lost[:_SHOWN]
    more = [f"{len(lost) - _SHOWN} more"] if len(lost) > _SHOWN else []
    where = listed([*(f"{one.count} after {one.seconds:.6g} s" for one in shown), *more])
    samples = "1 sample is" if total == 1 else f"{total} samples are"
    places = "1 place" if len(lost) == 1 else f"{len(lost)} places"
    return f"{samples} missing in {places}: {where}"


def _beginnings(recording: Recording, lost: tuple[Lost, ...]) -> str:
    more = ["…"] * (len(lost) > _SHOWN)
    return listed([*(str(recording.rows[0] + one.after + 1) for one in lost[:_SHOWN]), *more])


def _file(recording: Recording, *, alone: bool) -> str:
    return "the file" if alone or recording.source is None else recording.source.name


def _gap_of_joined(files: JoinedFiles, table: Table, gap: Gap) -> OddTime:
    """``gap.after`` is a sample of ``table``; the rows to write are of the first file."""
    lost = int(np.searchsorted(files.time, gap.begin, side="right")), int(np.searchsorted(files.time, gap.end))
    where = f"sample {gap.after} (the first is 0)" if table.lines is None else f"line {table.lines[gap.after]}"
    columns = ", ".join(f'"{column}"' for column in table.columns if column != files.clock)
    return OddTime(
        f'[[experiment]] "{files.recording.name}": {table.path.name}, {where}: {gap.in_brief}; what it has ({columns}) is missing there: '
        "outputs are left out of the comparison, inputs take their last value",
        f"{pieces_around(lost, files.rows)}, if an input is among these",
    )


def _clocks(data: DataSet) -> dict[str, TimeEntry]:
    """The time stamps of every experiment, as the card says; none where data are from memory."""
    card = card_at(data.path)
    return {e.name: time for e in card.experiment if (time := card.of(e).time)} if card else {}


def _unit(recording: Recording, first: Recording, clocks: Mapping[str, TimeEntry]) -> OddTime:
    """The faster one is likely read in too small a unit where the card says one below seconds, else the slower one in too large a one."""
    ratio = recording.sample_time / first.sample_time
    power = round(float(np.log10(ratio)) / 3.0)
    fast, slow = (_PREFIXED.index(clocks[r.name].unit) if r.name in clocks else 0 for r in (first, recording))
    wrong, unit = (first, fast - power) if fast >= power else (recording, min(slow + power, len(_PREFIXED) - 1))
    column = clocks[wrong.name].column if wrong.name in clocks else "…"
    entry = f'column = {toml_text(column)}, unit = "{_PREFIXED[unit]}"'
    return OddTime(
        f'[[experiment]] "{recording.name}": its sample time is {recording.sample_time:.4g} s, {ratio:.0f} times that of '
        f'"{first.name}" ({first.sample_time:.4g} s), as if one file counted in seconds and the other in milliseconds',
        f'columns = {{ time = {{ {entry} }} }} in [[experiment]] "{wrong.name}"',
    )


def _thousands(ratio: float) -> bool:
    power = round(float(np.log10(ratio)) / 3.0)
    return power >= 1 and abs(ratio / 1000.0**power - 1.0) < _SAME
