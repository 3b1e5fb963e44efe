"""Which files are of one run: loggers that recorded different signals over the same time, whose files a card joins."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from difflib import SequenceMatcher
from itertools import combinations
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.processing import at_times
from greybox_torch.drafting.channels import Drafted, drafted, wanted_of
from greybox_torch.drafting.clock import Clock
from greybox_torch.drafting.one_position import by_position
from greybox_torch.drafting.recorded import Recorded
from greybox_torch.model import GreyBoxModel

_SAME_TIME = 0.5
"""Share of the shorter of two files that the other one covers if both are of one run."""


@dataclass(frozen=True, eq=False)
class Run:
    """One experiment: ``files`` that were recorded together, the first of which has the time stamps that count.

    ``whole`` has the columns of all of them at these times, ``table`` the channels that are made of them. ``clock`` is that of the first,
    ``clocks`` those of all of several.
    """

    files: tuple[Recorded, ...]
    whole: Recorded
    clock: Clock
    table: Drafted
    clocks: tuple[Clock, ...] = ()

    @property
    def channels(self) -> set[str]:
        """Those that a column was found for."""
        return {draft.name for draft in self.table.channels if draft.column is not None}

    @property
    def dated(self) -> bool:
        """Whether the time stamps of all files have dates or times of day."""
        clocks = self.clocks or (self.clock,)
        return all(clock.column in file.stamps for clock, file in zip(clocks, self.files, strict=True))

    @property
    def step(self) -> float | None:
        """The usual step in s; None where it is not known."""
        if self.clock.column is None:
            return self.clock.sample_time
        return float(np.median(np.diff(_seconds(self))))

    @property
    def complete(self) -> bool:
        """Whether every channel has a column."""
        return len(self.channels) == len(self.table.channels)

    @property
    def signals(self) -> frozenset[str]:
        """The columns but for the time stamps."""
        return frozenset(self.whole.columns) - {self.clock.column or ""}


def runs_of(files: Sequence[Recorded], clocks: Sequence[Clock], model: GreyBoxModel | None) -> tuple[Run, ...]:
    """The runs in the order of their first files: every file is one, unless files of several loggers make up one."""
    first = drafted(files[0], clocks[0], model)
    further = [drafted(*other, model, first) for other in zip(files[1:], clocks[1:], strict=True)]
    alone = [Run((f,), f, c, table) for f, c, table in zip(files, clocks, [first, *further], strict=True)]
    whole = [] if model is None else [run for run in alone if run.complete]
    by_clock: dict[tuple[str | None, str], list[Run]] = {}
    for run in (run for run in alone if run not in whole):
        by_clock.setdefault((run.clock.column, run.clock.unit), []).append(run)
    by_name = [run for parts in by_clock.values() for run in _of_loggers(parts, model)]
    if model is None and len(by_clock) > 1:  # then columns and names are all that tells what is one signal, and one run
        by_name = _of_own_clocks(alone, None, named=True)
    elif len(by_clock) > 1:
        by_name = _of_own_clocks(_of_other_names(by_name, model), model, named=bool(whole))
    made = [*whole, *by_name]
    return tuple(sorted(made, key=lambda run: min(files.index(file) for file in run.files)))


def _of_other_names(runs: Sequence[Run], model: GreyBoxModel | None) -> Sequence[Run]:
    """The runs that single files make up whose time stamps have another name in each, at one position; as they are where none does."""
    single = [run for run in runs if len(run.files) == 1]
    places = by_position([run.whole for run in single], [run.clock for run in single])
    renamed = [replace(run, whole=file, clock=clock) for run, (file, clock) in zip(single, places, strict=False)]
    joined = [run for run in _of_loggers(renamed, model) if len(run.files) > 1] if renamed else []
    used = {file.path for run in joined for file in run.files}
    return [*joined, *(run for run in runs if run.files[0].path not in used)]


def _of_own_clocks(runs: Sequence[Run], model: GreyBoxModel | None, *, named: bool) -> Sequence[Run]:
    """The runs that the single files among these make up whose time stamps have another name or unit in each; with ``named``, if they
    have dates, or the names of their files a word in common: beside files that have all channels, others may lack some.
    """
    single = [run for run in runs if len(run.files) == 1 and run.clock.column is not None]
    made = _of_loggers(single, model) if single else []
    if named and not all(run.dated or _shared([file.path for file in run.files]) for run in made):
        return runs
    return [*made, *(run for run in runs if run not in single)]


def _of_loggers(parts: Sequence[Run], model: GreyBoxModel | None) -> Sequence[Run]:
    """The runs that files with time stamps of one kind make up, none of which has all channels of a model; the files as they are where
    it does not show which belong together.
    """
    loggers = _by_logger(parts, model)
    if len(loggers) < 2 or not _may_be_joined(loggers, model):
        return parts
    first, *others = loggers
    partners = [_partners(first, other) for other in others]
    together = [(run, *found) for run, *found in zip(first, *partners, strict=True) if all(found)]
    if not together or (model is None and len(together) < max(map(len, loggers))):
        return parts
    of_one = [[run for run in runs if run is not None] for runs in together]
    joined = [_joined(runs, model) for runs in of_one]
    if model is not None and not _gains(of_one[0], joined[0]):
        return parts
    used = {id(run) for runs in of_one for run in runs}
    return [*joined, *(run for run in parts if id(run) not in used)]


def fullest(runs: Sequence[Run]) -> list[int]:
    """The runs with as many channels as any: what results can be judged on. The others may have to be left out."""
    most = max(len(run.channels) for run in runs)
    return [k for k, run in enumerate(runs) if len(run.channels) == most]


def names_of(runs: Sequence[Run]) -> list[str]:
    """A name for each: what the names of its files have in common; of one file its name without the ending. Whole paths, where two would
    be alike.
    """
    names = [_common([file.path for file in run.files]) for run in runs]
    return [n if names.count(n) == 1 else run.files[0].path.as_posix() for n, run in zip(names, runs, strict=True)]


def _common(paths: Sequence[Path]) -> str:
    if len(paths) == 1:
        return paths[0].stem
    return "_".join(_shared(paths)) or paths[0].stem


def _shared(paths: Sequence[Path]) -> list[str]:
    """The words that all names have in common."""
    words = [re.findall(r"[^\W_]+", path.stem) for path in paths]
    return [word for word in words[0] if all(word in other for other in words[1:])]


def _by_logger(runs: Sequence[Run], model: GreyBoxModel | None) -> list[list[Run]]:
    """Files with the same columns are of one logger. First the one with most inputs, which are best not interpolated, if all are known."""
    loggers: dict[frozenset[str], list[Run]] = {}
    for run in runs:
        loggers.setdefault(run.signals, []).append(run)
    inputs = {channel.name for channel in wanted_of(model) if channel.is_input} if model is not None else set[str]()
    if inputs - {name for run in runs for name in run.channels}:
        return list(loggers.values())
    return sorted(loggers.values(), key=lambda of_one: -len(of_one[0].channels & inputs))


def _may_be_joined(loggers: Sequence[Sequence[Run]], model: GreyBoxModel | None) -> bool:
    """Whether all have sound time stamps in a column, and columns that the others lack."""
    if any(run.clock.broken for of_one in loggers for run in of_one):
        return False
    if any(run.clock.column is None for of_one in loggers for run in of_one):
        return False
    pairs = list(combinations([of_one[0].signals for of_one in loggers], 2))
    if model is None:
        return not any(one & other for one, other in pairs)
    return all(one - other and other - one for one, other in pairs)


def _gains(alone: Sequence[Run], joined: Run) -> bool:
    """Whether joining files finds channels of the model that none of them has; where no column is in two files, and dates tell that they
    are of one time, whether none has all.
    """
    most = max(len(run.channels) for run in alone)
    none_twice = all(run.dated for run in alone) and not any(
        one.signals & other.signals for one, other in combinations(alone, 2)
    )
    return len(joined.channels) > most or (none_twice and most < len(joined.table.channels))


def _partners(runs: Sequence[Run], others: Sequence[Run]) -> list[Run | None]:
    """For each run the one of another logger over the same time; where that leaves several, the one with the likest name. None for a run
    of which that does not tell; of two with the same partner, for the one that this is less like than the other.
    """
    found = [_partner(run, [other for other in others if _at_once(run, other)]) for run in runs]
    back = {
        id(one): _partner(one, [run for run, f in zip(runs, found, strict=True) if f is one]) for one in found if one
    }
    return [one if one is not None and back[id(one)] is run else None for run, one in zip(runs, found, strict=True)]


def _partner(run: Run, candidates: Sequence[Run]) -> Run | None:
    stem = run.files[0].path.stem
    alike = [SequenceMatcher(None, stem, other.files[0].path.stem).ratio() for other in candidates]
    best = [other for other, ratio in zip(candidates, alike, strict=True) if ratio == max(alike)]
    return best[0] if len(best) == 1 else None


def _at_once(run: Run, other: Run) -> bool:
    spans = [(stamps[0], stamps[-1]) for one in (run, other) for stamps in [_seconds(one)]]
    both = min(end for _, end in spans) - max(begin for begin, _ in spans)
    return both >= _SAME_TIME * min(end - begin for begin, end in spans)


def _seconds(run: Run) -> NDArray[np.float64]:
    """The time stamps (N,) of a run of one file, in s."""
    return run.whole.columns[run.clock.column or ""] * run.clock.seconds


def _joined(runs: Sequence[Run], model: GreyBoxModel | None) -> Run:
    """One run of several files, in which a column is that of the first file that has it, as joining reads it."""
    first, clock, times = runs[0].whole, runs[0].clock, _seconds(runs[0])
    columns, units = {}, {}
    for run in runs:
        kept = columns if run is runs[0] else {*columns, run.clock.column}
        new = {c: values for c, values in run.whole.columns.items() if c not in kept}
        columns |= {
            c: values if run is runs[0] else at_times(times, _seconds(run), values) for c, values in new.items()
        }
        units = {**run.whole.units, **units}
    files = tuple(run.files[0] for run in runs)
    faults = {column: fault for file in files for column, fault in file.faults.items()}
    whole = replace(first, columns=columns, units=units, faults=faults)
    return Run(files, whole, clock, drafted(whole, clock, model), tuple(run.clock for run in runs))
