"""The table of fits and errors, before and after, experiment by experiment."""

from __future__ import annotations

from dataclasses import dataclass

from greybox_torch.diagnosis.begun import begun
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.estimate.comparison import Score
from greybox_torch.report import text
from greybox_torch.report.about import About
from greybox_torch.report.sections.headline import digits_of_fit, units

_TITLES = {
    "validation": "Validation: held out while effects were chosen and tuned",
    "estimation": "Estimation: what everything was tuned on",
}
_COLUMNS = {
    "start": ("Start", "the card's values"),
    "refit": ("Refit", "re-estimated as it is"),
    "augmented": ("Augmented", "with the effects"),
}


@dataclass(frozen=True)
class Cell:
    fit: str
    error: str


@dataclass(frozen=True)
class Row:
    experiment: str
    output: str
    cells: tuple[Cell, ...]


@dataclass(frozen=True)
class Group:
    """The experiments of one role."""

    title: str
    rows: tuple[Row, ...]


@dataclass(frozen=True)
class Scores:
    """``columns`` are the models: their names, and a few words on each."""

    columns: tuple[tuple[str, str], ...]
    groups: tuple[Group, ...]
    held_out_by_default: bool
    begun: str = ""
    template: str = "scores.html.j2"

    @classmethod
    def of(cls, verdict: Verdict, about: About) -> Scores:
        models = ("start", "refit", "augmented") if verdict.effects else ("start", "refit")
        several = len({s.output for s in verdict.scores["start"]}) > 1
        together = list(zip(*(verdict.scores[m] for m in models), strict=True))
        groups = []
        for role, title in _TITLES.items():
            rows = tuple(
                _row(scores, units(verdict), several, digits_of_fit(verdict))
                for scores in together
                if scores[0].role == role
            )
            if rows:
                groups.append(Group(title, rows))
        return cls(tuple(_COLUMNS[m] for m in models), tuple(groups), about.held_out_by_default, begun(verdict))


def _row(scores: tuple[Score, ...], of: dict[str, str], several: bool, digits: int) -> Row:
    first = scores[0]
    cells = [Cell(text.fit(s.fit, digits), text.with_unit(text.number(s.rmse), of.get(s.output, ""))) for s in scores]
    return Row(first.experiment, text.words(first.output) if several else "", tuple(cells))
