"""Files that may be of one run and were not joined: what to do about it."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.data.clocks_written import in_clocks_to_fill_in
from greybox_torch.drafting.runs import Run


def apart(runs: Sequence[Run]) -> str:
    """What to do where files that were not joined have different channels of the model, of which none can be simulated; else ""."""
    maybe_whole = [run for run in runs if run.complete or len(run.signals) == len(run.table.channels)]
    first, *others = [run for run in runs if run not in maybe_whole] or runs[:1]
    for run in others:
        if run.channels - first.channels or (run.clock.column is not None and not run.channels):
            return _joined(first, run)
    return ""


def apart_without_a_model(runs: Sequence[Run]) -> str:
    """The same where a further file has no column that is called as one of the first."""
    first, *others = runs
    strange = [run for run in others if run.channels and not run.channels & first.channels]
    return _joined(first, strange[0]) if strange else ""


def _joined(first: Run, run: Run) -> str:
    names = [one.files[0].path.name for one in (first, run)]
    clocks = in_clocks_to_fill_in(names[1], "column", "unit", "offset")
    return (
        f"[[experiment]]: {names[0]} and {names[1]} have different channels; if they are of one run, one experiment with both: "
        f'file = ["{names[0]}", "{names[1]}"], join = "time", which needs time stamps in each; of another name, unit or zero than time at '
        f"the top says: {clocks}"
    )
