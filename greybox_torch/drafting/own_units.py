"""Units of further files of a card, where they are not those of the first: what the files say, or else what sizes of the samples tell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.data.column_units import unit_in
from greybox_torch.data.units import conversion
from greybox_torch.drafting.channels import Draft
from greybox_torch.drafting.clock import SECONDS
from greybox_torch.drafting.runs import Run
from greybox_torch.errors import UserError

_NEARER = 3.0
"""By what factor sizes have to agree better in one unit than in the other."""

_MOST = 0.9
"""Share of the samples that are no larger than what is compared: the largest may be error codes."""


@dataclass(frozen=True)
class OwnUnit:
    """Of a channel in a further file: the ``file_unit`` that this experiment has to say, None where it is the first one's; ``guess`` says
    what that was guessed from, to be checked, and is empty where the file says it.
    """

    file_unit: str | None
    guess: str = ""


def own_units(run: Run, first: Run) -> dict[str, OwnUnit]:
    """By channel, of those of a further ``run`` whose unit is not, or not surely, what the ``first`` one's line on the card says."""
    found: dict[str, OwnUnit] = {}
    for draft, drafted in zip(run.table.channels, first.table.channels, strict=False):
        if None in (draft.column, drafted.column) or (draft.name, draft.unit) != (drafted.name, drafted.unit):
            continue
        own = _own_unit(draft, run, drafted, first)
        if own is not None:
            found[draft.name] = own
    return found


def units_of_others(runs: Sequence[Run]) -> tuple[tuple[Run, ...], list[str]]:
    """The runs, the first one with such units of its channels as it does not say and a further one does, if sizes of the samples agree with
    that; and a line for each of them, to be checked, to begin with the channel.
    """
    first, told, drafts = runs[0], list[str](), list[Draft]()
    for k, draft in enumerate(first.table.channels):
        other = next((run for run in runs[1:] if _says_a_unit(draft, first, run.table.channels[k : k + 1])), None)
        known = None if other is None else other.table.channels[k]
        as_there = None if other is None or known is None else _converted_already(draft, first, known, other)
        if other is None or known is None or as_there:  # then it is in the channel's unit
            drafts.append(draft)
            continue
        theirs = f'"{known.column}" of {other.whole.path.name}'
        guess = (
            f"no unit is said, and {theirs} is in {known.file_unit}"
            if as_there is None
            else f"no unit is said: {known.file_unit} by its size beside that of {theirs}"
        )
        unit = draft.file_unit if as_there is None else known.file_unit
        drafts.append(replace(draft, file_unit=unit, remark=f"{guess}; please check"))
        told.append(f"[channels] {draft.name}: {guess}; please check")
    return (replace(first, table=replace(first.table, channels=tuple(drafts))), *runs[1:]), told


def _says_a_unit(draft: Draft, first: Run, theirs: Sequence[Draft]) -> bool:
    """Whether the draft of a channel in another run has a unit of the file which that in the first one lacks."""
    column = draft.column
    if column is None or draft.file_unit or not draft.unit or first.whole.units.get(column) or unit_in(column):
        return False
    return any(other.name == draft.name and other.column is not None and other.file_unit for other in theirs)


def own_unit_of_time(run: Run, first: Run) -> str | None:
    """The unit of a further ``run``'s time stamps that its experiment has to say; None where it is the ``first`` one's. Where nothing says
    it, it is the first one's as well if the steps are then nearer to the first one's.
    """
    here, there = run.clock, first.clock
    if None in (here.column, there.column) or here.unit == there.unit:
        return None
    steps = [float(np.median(np.diff(one.whole.columns[one.clock.column or ""]))) for one in (run, first)]
    seconds = [SECONDS.get(clock.unit, 1.0) for clock in (here, there)]
    as_there = abs(np.log(steps[0] / steps[1]))
    as_here = abs(np.log(steps[0] * seconds[0] / (steps[1] * seconds[1])))
    return None if not here.said and as_there < as_here else here.unit


def _own_unit(draft: Draft, run: Run, drafted: Draft, first: Run) -> OwnUnit | None:
    column = draft.column or ""
    if draft.file_unit == drafted.file_unit or not draft.unit:
        return None
    if run.whole.units.get(column) or unit_in(column) or draft.file_unit:
        return OwnUnit(draft.file_unit or draft.unit)
    converted = _converted_already(draft, run, drafted, first)
    theirs = f'"{drafted.column}" of {first.whole.path.name}'
    if converted is None:
        return OwnUnit(None, f"no unit is said: it is converted from {drafted.file_unit}, as {theirs} is")
    unit = draft.unit if converted else drafted.file_unit
    told = f"no unit is said: {unit} by its size beside that of {theirs}"
    return OwnUnit(unit if converted else None, told)


def _converted_already(draft: Draft, run: Run, drafted: Draft, first: Run) -> bool | None:
    """Whether samples are as large as those of the first file once these are converted, and not as they stand there; None where that does
    not tell.
    """
    try:
        factor, offset = conversion(drafted.file_unit, draft.unit, "")
    except UserError:
        return None
    here, there = run.whole.columns[draft.column or ""], first.whole.columns[drafted.column or ""]
    sizes = [float(np.nanquantile(np.abs(values), _MOST)) for values in (here, there, factor * there + offset)]
    if not all(0.0 < size < np.inf for size in sizes):
        return None
    apart = [abs(np.log(sizes[0] / size)) for size in sizes[1:]]
    if abs(apart[0] - apart[1]) < np.log(_NEARER):
        return None
    return bool(apart[1] < apart[0])
