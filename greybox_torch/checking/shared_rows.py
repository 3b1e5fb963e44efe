"""Rows of a file, or of a copy of it, that parameters are estimated from and that results are judged on as well."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from filecmp import cmp
from itertools import combinations
from math import inf
from pathlib import Path

from greybox_torch.data import DataSet
from greybox_torch.data.card import Card, card_at
from greybox_torch.data.card_channels import ExperimentEntry
from greybox_torch.data.data_warning import InASentence


@dataclass(frozen=True)
class SharedRows(InASentence):
    """``shared`` says which rows of which file the experiments ``estimated`` and ``judged`` both have. ``held_out``: the card names no
    validation, and the last quarter of each is judged.
    """

    estimated: str
    judged: str
    shared: str
    held_out: bool

    @property
    def found(self) -> str:
        """What is there, in a sentence."""
        one, other = ("", "") if self.held_out else (" (estimation)", " (validation)")
        also = ", and the last quarter of each is held out" if self.held_out else ""
        return (
            f'[[experiment]] "{self.estimated}"{one} and "{self.judged}"{other} both have {self.shared}{also}: '
            "results are judged on samples that they were estimated from"
        )

    @property
    def write(self) -> str:
        """What to write instead."""
        return "rows that do not overlap, or another file for one of them"


def shared_rows(data: DataSet) -> Iterator[SharedRows]:
    """Of every two experiments on the card of which one is judged on samples of the other; none where data are from memory."""
    card, held_out = card_at(data.path), data.held_out_by_default
    if card is None or data.path is None:
        return
    for one, other in combinations(card.experiment, 2):
        alike = one.rows == other.rows if held_out else one.role == other.role  # nothing of one is judged on the other
        if alike or _of_other_columns(card, one, other):  # runs that stand side by side in one file
            continue
        first, second = (one, other) if one.role == "estimation" else (other, one)
        shared = _shared(one, other, data.path.parent)
        if shared:
            yield SharedRows(first.name, second.name, shared, held_out)


def _of_other_columns(card: Card, one: ExperimentEntry, other: ExperimentEntry) -> bool:
    """Whether a channel is made of other columns in one of them, whatever these are multiplied by."""
    first, second = card.formulas(one), card.formulas(other)
    return any(first[name].text != second[name].text for name in first.keys() & second.keys())


def _shared(one: ExperimentEntry, other: ExperimentEntry, folder: Path) -> str:
    """The rows that two experiments share, in words; empty where there are none, or where no card can say which row is in which file."""
    files = [[(folder / file).resolve() for file in experiment.file] for experiment in (one, other)]
    copies = {other: one for one in files[0] for other in files[1] if _same_bytes(one, other)}
    files[1] = [copies.get(file, file) for file in files[1]]
    common = [file for file in files[0] if file in files[1]]
    joined = files[0] != files[1] and any(len(e.file) > 1 and e.rows for e in (one, other))
    (start, stop), (begin, end) = (e.rows or (0, inf) for e in (one, other))
    start, stop = max(start, begin), min(stop, end)
    if not common or joined or start >= stop:
        return ""
    copy = next((other for other, one in copies.items() if one == common[0] and other != one), None)
    file = common[0].name if copy is None else f"{common[0].name}, of which {copy.name} is a copy"
    return f"all of {file}" if stop == inf else f"rows [{start}, {stop}] of {file}"


def _same_bytes(one: Path, other: Path) -> bool:
    """Whether two files are the same, or one a copy of the other under another name."""
    if one == other:
        return True
    try:
        return one.stat().st_size == other.stat().st_size > 0 and cmp(one, other, shallow=False)
    except OSError:  # gone meanwhile
        return False
