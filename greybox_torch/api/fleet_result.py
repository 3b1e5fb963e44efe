"""What the diagnosis of many machines comes to."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.text import Text

from greybox_torch.api.result import Result
from greybox_torch.fleets.charts import change_sentences
from greybox_torch.fleets.history import History, histories
from greybox_torch.fleets.in_common import Group, groups
from greybox_torch.fleets.journal import JOURNAL, line
from greybox_torch.fleets.page import ANSWER_WORDS, FAILURE_WORDS, PAGE, counted, render_fleet, told_as
from greybox_torch.fleets.parquet import TABLE, parquet
from greybox_torch.fleets.row import Row
from greybox_torch.fleets.suggested_beliefs import SuggestedBeliefs, suggested_beliefs
from greybox_torch.report import notebook
from greybox_torch.report.tables import print_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCHEMA = "greybox-fleet/1"
DIGITS = 4
_COLUMNS = [
    "data set",
    "answer",
    "effect",
    "probability",
    "parameter",
    "value",
    "std",
    "unit",
    "fit before",
    "after",
    "seconds",
]
_COLOURS = {"named": "C0", "unknown": "C1", "missing": "C2", "nothing": "0.5", "unfinished": "0.7"}


@dataclass(frozen=True, eq=False, repr=False)
class FleetResult(Result):
    """The table of a fleet, a row for every data set that is done, sorted by name; ``waiting`` others are not, where it was stopped.

    ``seconds`` are those of the whole run.
    """

    table: tuple[Row, ...]
    waiting: int = 0
    complete: bool = True
    seconds: float = 0.0

    @property
    def rows(self) -> list[dict[str, Any]]:
        """A row for every data set, as `fleet.jsonl` has it."""
        return [row.as_json() for row in self.table]

    @cached_property
    def histories(self) -> tuple[History, ...]:
        """Machines with several dated recordings, and what changed."""
        return histories(self.table)

    @cached_property
    def common(self) -> tuple[Group, ...]:
        """What machines with the same effect have in common, and which stand out."""
        return groups(self.table)

    @cached_property
    def suggested_beliefs(self) -> tuple[SuggestedBeliefs, ...]:
        """What the fleet says beforehand of further machines, by model: tables `[beliefs]` for their cards."""
        return suggested_beliefs(self.table)

    @property
    def changes(self) -> list[dict[str, Any]]:
        """A row for every change of a machine over time."""
        return [change for history in self.histories for change in history.as_json()]

    @property
    def sentence(self) -> str:
        """How many data sets came to which answer."""
        told = ", ".join(f"{count} {words}" for _, words, count in counted(self.table))
        stopped = f"; stopped with {self.waiting} to go" if self.waiting else ""
        return f"{len(self.table)} data sets: {told or 'none done'}{stopped}."

    def __repr__(self) -> str:
        return f"<fleet: {self.sentence}>"

    def content(self, folder: Path) -> dict[str, Any]:
        return {
            "schema": SCHEMA,
            "seconds": self.seconds,
            "complete": self.complete,
            "waiting": self.waiting,
            "machines": self.rows,
            "changes": self.changes,
            "common": [group.as_json() for group in self.common],
            "beliefs": [one.as_json() for one in self.suggested_beliefs],
            "page": str(folder / PAGE),
        }

    def show(self, console: Console) -> None:
        console.print(Text(self.sentence, style="bold"), soft_wrap=True)
        if self.table:
            print_table(console, _COLUMNS, self._cells(), prose=["effect"], digits=DIGITS)
        for text in self._notes():
            console.print(Text(text), soft_wrap=True)

    def files(self, folder: Path) -> dict[Path, str | bytes]:
        return {
            folder / PAGE: render_fleet(
                self.table, self.common, self.histories, suggested=self.suggested_beliefs, waiting=self.waiting
            ),
            folder / TABLE: parquet(self.table),
            folder / JOURNAL: "".join(line(row) for row in self.table),
            **{folder / one.file: one.toml() for one in self.suggested_beliefs},
        }

    def plot(self) -> Figure:
        """The validation fit with the effects over that without, a point for every data set."""
        import matplotlib.pyplot as plt

        from greybox_torch.report.style import STYLE

        with plt.rc_context(STYLE):
            figure, axes = plt.subplots(figsize=(5.0, 4.6), layout="constrained")
            for answer, colour in _COLOURS.items():
                told = [(r.fit_before, r.fit_after) for r in self.table if told_as(r) == answer]
                known = [(before, after) for before, after in told if before is not None and after is not None]
                if known:
                    axes.scatter(*zip(*known, strict=True), s=14, color=colour, label=ANSWER_WORDS[answer])
            axes.axline((100.0, 100.0), slope=1.0, color="0.7", linewidth=0.8)
            axes.set(xlabel="validation fit re-estimated [%]", ylabel="with the effects [%]")
            if axes.collections:
                axes.legend(fontsize=8)
        plt.close(figure)
        return figure

    def _repr_html_(self) -> str:
        notes = [notebook.sentence(text) for text in self._notes()]
        rows = [notebook.table(_COLUMNS, self._cells(), DIGITS)] if self.table else []
        picture = notebook.picture(self.plot(), "validation fit before and after, of all data sets")
        return notebook.page("Fleet", notebook.sentence(self.sentence, "found"), *rows, *notes, picture)

    def _cells(self) -> list[list[str | float]]:
        return [_cells(row) for row in self.table]

    def _notes(self) -> list[str]:
        failed = [
            f"{row.dataset}: {FAILURE_WORDS.get(row.failure, 'failed')}: {row.message}"
            for row in self.table
            if row.failed
        ]
        changed = [f"{history.machine}: {text}" for history in self.histories for text in change_sentences(history)]
        outlying = [
            f"{row.machine}: {group.name} is {residual:+.1f} deviations from what the other machines say."
            for group in self.common
            for row, _, residual in group.outliers
        ]
        known = [
            f"{one.file}: what {one.of} machines of {one.model} were found with, as [beliefs] for the cards of further ones."
            for one in self.suggested_beliefs
        ]
        return [*failed, *changed, *outlying, *known]


def _cells(row: Row) -> list[str | float]:
    sure = row.probability if row.effect else row.confidence
    numbers = [row.value, row.std, row.fit_before, row.fit_after]
    value, std, before, after = ("" if n is None else n for n in numbers)
    return [
        row.dataset,
        ANSWER_WORDS[told_as(row)],
        row.effect,
        "" if sure is None or row.failed else sure,
        row.parameter,
        value,
        std,
        row.unit,
        before,
        after,
        row.seconds,
    ]
