"""Channels that are made of the same column: one of them is another signal than the model takes it for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations

from greybox_torch.data import DataSet
from greybox_torch.data.card import Card, card_at
from greybox_torch.data.card_channels import ChannelEntry
from greybox_torch.data.data_warning import InASentence
from greybox_torch.data.expression import Expression
from greybox_torch.in_unit import in_unit


@dataclass(frozen=True)
class SharedColumn(InASentence):
    """Two ``channels`` with their units, and the ``column``; ``experiment`` is empty where all share it."""

    channels: tuple[str, str]
    column: str
    experiment: str
    write: str

    @property
    def found(self) -> str:
        """What is there, in a sentence."""
        where = f'[[experiment]] "{self.experiment}", columns: ' if self.experiment else "[channels] "
        one, other = self.channels
        return f'{where}{one} and {other} are both read from "{self.column}"'


def shared_columns(data: DataSet) -> Iterator[SharedColumn]:
    """Of every two channels that are the same column, or computed from columns in the same way; none where data are from memory."""
    whole, told = card_at(data.path), set[tuple[str, str]]()
    if whole is None:
        return
    for experiment in whole.experiment:
        card = whole.of(experiment)
        formulas = card.formulas(experiment)
        for one, other in combinations(formulas, 2):
            column = _shared(card, formulas, one, other)
            if column and (one, other) not in told:
                told.add((one, other))
                own = {one, other} & set(experiment.columns)
                names = _named(one, card.channels[one]), _named(other, card.channels[other])
                where = _where_a_scale_may_stand(card.channels[one], card.channels[other])
                write = f"the column of each; or {where}, if both are meant to be it"
                yield SharedColumn(names, column, experiment.name if own else "", write)


def _shared(card: Card, formulas: Mapping[str, Expression], one: str, other: str) -> str:
    """The column that two channels share in an experiment; else "". A derivative is another signal; a factor is meant."""
    entries = card.channels[one], card.channels[other]
    scaled = any("scale" in entry.model_fields_set for entry in entries)
    text = formulas[one].text
    alike = text == formulas[other].text and entries[0].derivative == entries[1].derivative
    return text if alike and not scaled else ""


def _where_a_scale_may_stand(one: ChannelEntry, other: ChannelEntry) -> str:
    """How a card says that both are meant: a line with a file_unit takes no scale."""
    with_unit = [entry.file_unit is not None for entry in (one, other)]
    if all(with_unit):
        return "expr with the factor, in the place of column and file_unit, in one of the two lines"
    return f"scale = 1.0 in {'the line that has no file_unit' if any(with_unit) else 'one of the two lines'}"


def _named(name: str, entry: ChannelEntry) -> str:
    return in_unit(f'"{name}"', f"[{entry.unit}]" if entry.unit not in ("", "1") else "")
