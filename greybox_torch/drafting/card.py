"""The text of a first data card, with comments that say what was guessed and what is left to fill in."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from greybox_torch.data.clocks_written import clock_written
from greybox_torch.data.gaps import Gap, pieces_around
from greybox_torch.data.summer_time import instead_of_summer_time
from greybox_torch.drafting.apart import apart, apart_without_a_model
from greybox_torch.drafting.channels import Draft, wanted_of
from greybox_torch.drafting.chosen import FEW, held_out
from greybox_torch.drafting.clock import Clock, clock_of
from greybox_torch.drafting.further_runs import guessed_units, in_toml, of_further_runs, own_clocks, own_columns
from greybox_torch.drafting.odd_cells import missing_of, to_be_mended, where_missing_of
from greybox_torch.drafting.one_run import perhaps_one_run
from greybox_torch.drafting.own_units import units_of_others
from greybox_torch.drafting.recorded import Recorded, recorded
from greybox_torch.drafting.refused import of_other_steps, why_refused
from greybox_torch.drafting.runs import Run, fullest, names_of, runs_of
from greybox_torch.files import toml_key, toml_text
from greybox_torch.model import GreyBoxModel

_JOIN = 'join = "time"                  # columns of all, at the time stamps of the first'


@dataclass(frozen=True)
class CardDraft:
    """The card's text, and what its reader has to do: ``open`` lists what could not be guessed. ``runs`` are the files by experiment,
    ``held_out`` says what was chosen for validation.
    """

    text: str
    files: tuple[Recorded, ...]
    runs: tuple[Run, ...]
    clock: Clock
    channels: tuple[Draft, ...]
    open: tuple[str, ...]
    held_out: str = ""


def draft_card(
    paths: Sequence[Path],
    folder: Path,
    model: GreyBoxModel | None = None,
    model_name: str | None = None,
    sample_time: float | None = None,
) -> CardDraft:
    """The card that would stand in ``folder`` for the recordings ``paths``.

    Args:
        model_name: how the card names the model, relative to ``folder``.
        sample_time: in seconds; by default guessed.

    Raises:
        UserError: a file that cannot be read.
    """
    files = tuple(recorded(path) for path in paths)
    given = None if sample_time is None else Clock(sample_time=sample_time, remark="as given")
    wanted = [] if model is None else wanted_of(model)
    clocks = [given or clock_of(file, [one.name for one in wanted]) for file in files]
    runs, of_units = units_of_others(runs_of(files, clocks, model))
    first = runs[0]
    lines = [
        f"name = {toml_text(folder.resolve().name or 'Recordings')}",
        *_clock(first.clock),
        'hold = "zoh"                       # the input between samples: "zoh" constant, "foh" straight lines',
        "",
        *_channels(runs, model),
        *_left_over(first),
        "",
        *_experiments(runs, folder),
        *_model(model, model_name),
    ]
    missing = [f"[channels] {draft.name}: {draft.remark}" for draft in first.table.channels if draft.column is None]
    if missing:  # what there is to them may be in a column that could not be read, or in another file
        missing += [fault for file in first.files for fault in _faults(file)]
    parted = apart(runs) if model is not None else apart_without_a_model(runs)
    if model is not None and not (parted and missing):  # what the first lacks goes for all that are to be joined
        missing += of_further_runs(runs)
    missing += [*of_units, *filter(None, [parted])]
    missing += to_be_mended(runs)
    missing[:0] = [f"time: {clock.broken}" for clock in clocks if clock.broken]
    missing += of_other_steps(runs)
    if first.clock.column is None and first.clock.sample_time is None:
        missing.insert(0, f"sample_time: {first.clock.remark}")
    if what_to_do := perhaps_one_run(files, clocks, 2 if model is None else len(wanted)):
        missing.append(what_to_do)
    text = "\n".join(lines) + "\n"
    if all("please check" in told for told in missing):  # else it cannot be read before something is filled in
        missing += why_refused(text, folder)
    channels = tuple(_remarked(runs, draft) for draft in first.table.channels)
    return CardDraft(text, files, runs, first.clock, channels, tuple(missing), held_out(runs))


def _clock(clock: Clock) -> list[str]:
    if clock.column is not None:
        more = f", unit = {toml_text(clock.unit)}" if clock.unit != "s" else ""
        more += f", date = {toml_text(clock.date)}" if clock.date else ""
        column = toml_text(clock.column) if clock.position is None else str(clock.position)
        time = f"{{ column = {column}{more} }}" if more else column
        uneven = f"# resample = {clock.uneven}    # s: the time stamps are uneven; this makes them even"
        return [f"time = {time}    # {clock.remark}", *([uneven] if clock.uneven else [])]
    if clock.sample_time is not None:
        return [f"sample_time = {clock.sample_time!r}    # s, {clock.remark}"]
    return [f"# sample_time = 0.001              # s, to be filled in: {clock.remark}"]


def _remarked(runs: Sequence[Run], draft: Draft) -> Draft:
    """With what was taken for a missing sample."""
    told = [remark for remark in (draft.remark, where_missing_of(runs, draft.name)) if remark]
    return replace(draft, remark="; ".join(told))


def _channels(runs: Sequence[Run], model: GreyBoxModel | None) -> list[str]:
    told = (
        "# name = { column = …, unit = … }; file value * scale = value in unit, or file_unit = … to convert"
        if model is not None
        else "# no model was named: call channels as the model's inputs and outputs are called"
    )
    drafts = [(_remarked(runs, draft), missing_of(runs, draft.name)) for draft in runs[0].table.channels]
    return ["[channels]", told, *(_channel(*draft) for draft in drafts)]


def _channel(draft: Draft, missing: str) -> str:
    column = f"column = {toml_text(draft.column if draft.column is not None else '…')}"
    entry = [f"expr = {toml_text(draft.expr)}" if draft.expr else column, f"unit = {toml_text(draft.unit)}"]
    entry += [f"file_unit = {toml_text(draft.file_unit)}"] if draft.file_unit else []
    entry += [missing] if missing else []
    line = f"{toml_key(draft.name)} = {{ {', '.join(entry)} }}" + (f"    # {draft.remark}" if draft.remark else "")
    return line if draft.column is not None else f"# {line}"


def _left_over(run: Run) -> list[str]:
    lines = []
    for file in run.files:
        others = [name for name in file.columns if name in run.table.others]
        lines += [f"# also in {file.path.name}: {', '.join(others)}"] if others else []
        lines += [f"# of another length: {', '.join(file.left_out)}"] if file.left_out else []
        lines += [f"# left out: {fault}" for fault in _faults(file)]
    return lines


def _faults(file: Recorded) -> list[str]:
    """The columns that were left out as they hold something else than numbers, with what that is and where."""
    faults = {name: fault for name, fault in file.faults.items() if name not in file.columns}
    return [f'column "{name}" of {file.path.name}, {fault}' for name, fault in faults.items()]


def _experiments(runs: Sequence[Run], folder: Path) -> list[str]:
    lines: list[str] = []
    names, full = names_of(runs), fullest(runs)
    open_ones = {draft.name for draft in runs[0].table.channels if draft.column is None}
    for k, run in enumerate(runs):
        every, guessed = own_columns(run, runs[0]), guessed_units(run, runs[0])
        own = {name: entry for name, entry in every.items() if name not in open_ones}
        later = {name: entry for name, entry in every.items() if name in open_ones}
        alone, samples = full == [k], run.whole.samples  # then nothing else can be estimated from
        if alone and samples >= FEW:
            cut = 3 * samples // 4
            for name, role, rows in (
                ("first part", "estimation", (0, cut)),
                ("last part", "validation", (cut, samples)),
            ):
                lines += _experiment(f"{names[k]}, {name}", run, role, folder, own, later, guessed, rows)
            continue
        role = "validation" if k == full[-1] and not alone else "estimation"
        lines += _experiment(names[k], run, role, folder, own, later, guessed, None)
    return lines


def _experiment(
    name: str,
    run: Run,
    role: str,
    folder: Path,
    columns: dict[str, dict[str, str]],
    later: dict[str, dict[str, str]],
    guessed: str,
    rows: tuple[int, int] | None,
) -> list[str]:
    seen = "parameters are estimated from it" if role == "estimation" else "results are judged on it"
    seen += "; chosen as the last file" if role == "validation" and rows is None else ""
    places = {str(f.path): Path(os.path.relpath(f.path.resolve(), folder.resolve())).as_posix() for f in run.files}
    files = [toml_text(place) for place in places.values()]
    clocks = [clock_written(places[file], **entry) for file, entry in own_clocks(run).items()]
    return [
        *_gap(run.clock.gap, rows or (0, run.whole.samples)),
        "[[experiment]]",
        f"name = {toml_text(name)}",
        f"file = {files[0] if len(files) == 1 else '[' + ', '.join(files) + ']'}",
        *([_JOIN] if len(files) > 1 else []),
        *([f"clocks = {{ {', '.join(clocks)} }}"] if clocks else []),
        f"role = {toml_text(role)}              # {seen}",
        *([f"rows = [{rows[0]}, {rows[1]}]"] if rows else []),
        *([f"# {guessed}; please check"] if guessed else []),
        *([f"columns = {{ {in_toml(columns)} }}"] if columns else []),
        *([f"# and, once [channels] has them: {in_toml(later)}"] if later else []),
        "",
    ]


def _gap(gap: Gap | None, rows: tuple[int, int]) -> list[str]:
    """What to do about a gap that lies in an experiment with ``rows``."""
    if gap is None or not rows[0] <= gap.after < rows[1] - 1:
        return []
    if gap.of_summer_time:
        return [
            f"# {gap.in_brief}: as where local time is set to summer time.",
            f"# Then nothing is missing: give {instead_of_summer_time(gap.step)}.",
        ]
    return [
        f"# {gap.in_brief}: a simulation across it would hold the last input.",
        f"# Write {pieces_around((gap.after + 1, gap.after + 1), rows)}.",
    ]


def _model(model: GreyBoxModel | None, name: str | None) -> list[str]:
    if model is None:
        return ["[model]", '# name = "my_model.py:MyModel"      # relative to this card']
    parameters = [
        f"# {toml_key(p.name)} = {{ value = {p.value!r}{', fixed = true' if p.fixed else ''} }}"
        + (f"    # {p.unit}" if p.unit else "")
        for p in model.declared_parameters
    ]
    told = "# start values; with fixed = true what you know" if parameters else ""
    return [
        "[model]",
        f"name = {toml_text(name or model.title)}",
        *(["", "[model.parameters]", told, *parameters] if told else []),
    ]
