"""What is to be looked at in further files of a card: the channels that they lack, and units that the first file alone says."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.drafting.runs import Run, names_of


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
            elif draft.column not in (None, drafted.column) and drafted.file_unit and not draft.file_unit:
                told.append(
                    f'{place}, {draft.name}: the name of "{draft.column}" says no unit: it is converted from {drafted.file_unit}, as '
                    f'"{drafted.column}" is; where it is in another unit, this file needs a card of its own'
                )
        if run.clock.column is not None and first.clock.column is not None and run.clock.unit != first.clock.unit:
            told.append(
                f'{place}, time: "{run.clock.column}" is in {run.clock.unit}, and that of the first file in {first.clock.unit}; '
                "expected one unit of time in all files of a card: this one needs a card of its own"
            )
    return told
