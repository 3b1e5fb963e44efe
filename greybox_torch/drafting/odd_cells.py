"""Texts here and there in a column of numbers: marks of missing samples that a card declares, and mistakes that only the file can mend."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from greybox_torch.drafting.recorded import Recorded
from greybox_torch.drafting.runs import Run
from greybox_torch.files import toml_text


def _odd(runs: Sequence[Run], channel: str) -> Iterator[tuple[Recorded, str]]:
    """The files in which the column of a channel has such texts."""
    for run in runs:
        column = run.table.columns.get(channel)
        for file in run.files:
            if column in file.columns and (column in file.faults or column in file.marks):
                yield file, column


def missing_of(runs: Sequence[Run], channel: str) -> str:
    """The entry `missing = …` of a channel; "" where it needs none."""
    marks = list(dict.fromkeys(mark for file, column in _odd(runs, channel) for mark in file.marks.get(column, ())))
    if not marks:
        return ""
    listed = ", ".join(toml_text(mark) for mark in marks)
    return f"missing = {listed}" if len(marks) == 1 else f"missing = [{listed}]"


def where_missing_of(runs: Sequence[Run], channel: str) -> str:
    """Where the first of them is, for the remark of the channel; "" where there is none."""
    for file, column in _odd(runs, channel):
        if column in file.marks:
            text, where = toml_text(file.marks[column][0]), file.marked_at[column]
            return f"{text} in {where} of {file.path.name} is taken for a missing sample"
    return ""


def to_be_mended(runs: Sequence[Run]) -> list[str]:
    """The texts that are no marks, the first of each channel and file."""
    return [
        f'[channels] {draft.name}: column "{column}" of {file.path.name}, {file.faults[column]}; to be mended in the file'
        for draft in runs[0].table.channels
        for file, column in _odd(runs, draft.name)
        if column in file.faults
    ]
