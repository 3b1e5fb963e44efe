"""Further files of a card: their own columns and units, and what is to be looked at there, such as channels that they lack."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from greybox_torch.drafting.own_units import own_unit_of_time, own_units
from greybox_torch.drafting.runs import Run, names_of
from greybox_torch.files import toml_key, toml_text


def own_columns(run: Run, first: Run) -> dict[str, dict[str, str]]:
    """The entries of an experiment's `columns`: of columns with another name or unit than in the ``first`` run."""
    own: dict[str, dict[str, str]] = {}
    units = own_units(run, first)
    for draft, drafted in zip(run.table.channels, first.table.channels, strict=False):
        unit = units[draft.name].file_unit if draft.name in units else None
        if draft.column is not None and (unit is not None or draft.column != drafted.column):
            own[draft.name] = _entry(draft.column, "file_unit", unit)
    here, there, unit = run.clock, first.clock, own_unit_of_time(run, first)
    if None not in (here.column, there.column) and (unit is not None or here.written[::2] != there.written[::2]):
        own["time"] = _entry(str(here.column), "unit", unit) | ({"date": here.date} if here.date else {})
    return own


def own_clocks(run: Run) -> dict[str, dict[str, str]]:
    """By path of further files of a run, what its `clocks` say of those whose time stamps are not called as the first one's, or not in its
    unit.
    """
    own: dict[str, dict[str, str]] = {}
    for file, clock in zip(run.files, run.clocks, strict=False):
        if clock.written != run.clock.written and clock.column is not None:
            more = {"unit": clock.unit} if clock.unit != run.clock.unit else {}
            own[str(file.path)] = {"column": clock.column} | more | ({"date": clock.date} if clock.date else {})
    return own


def guessed_units(run: Run, first: Run) -> str:
    """A remark behind these columns, where units of them were guessed; else ""."""
    return "; ".join(f"{channel}: {unit.guess}" for channel, unit in own_units(run, first).items() if unit.guess)


def _entry(column: str, key: str, unit: str | None) -> dict[str, str]:
    return {"column": column} | ({} if unit is None else {key: unit})


def in_toml(own: Mapping[str, Mapping[str, str]]) -> str:
    """Entries of `columns` as they stand on a card."""
    entries = {
        name: toml_text(entry["column"])
        if len(entry) == 1
        else f"{{ {', '.join(f'{key} = {toml_text(value)}' for key, value in entry.items())} }}"
        for name, entry in own.items()
    }
    return ", ".join(f"{toml_key(name)} = {entry}" for name, entry in entries.items())


def of_further_runs(runs: Sequence[Run]) -> list[str]:
    """A line for each, to begin with the experiment; none of a single run."""
    first, told = runs[0], list[str]()
    for name, run in list(zip(names_of(runs), runs, strict=True))[1:]:
        place = f'[[experiment]] "{name}"'
        for draft, drafted in zip(run.table.channels, first.table.channels, strict=False):
            if draft.column is None and drafted.column is not None and drafted.column not in run.whole.columns:
                others = [column for file in run.files for column in file.left_out]
                more = f"; of another length: {', '.join(others)}" if others else ""
                remark = draft.remark.partition("; or, of a constant")[0]
                told.append(f"{place}, {draft.name}: {remark}{more}; else leave the experiment out")
        units = own_units(run, first)
        told += [f"{place}, {channel}: {unit.guess}; please check" for channel, unit in units.items() if unit.guess]
    return told
