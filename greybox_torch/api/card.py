"""A first data card from recordings."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.text import Text

from greybox_torch.api.drafted_file import DraftedFile
from greybox_torch.data import DataSet, Recording
from greybox_torch.data.card import USUAL
from greybox_torch.drafting.card import CardDraft, draft_card
from greybox_torch.drafting.further_runs import own_clocks, own_columns
from greybox_torch.drafting.runs import names_of
from greybox_torch.errors import ArgumentError, UserError
from greybox_torch.files import absolute
from greybox_torch.keywords import names_checked
from greybox_torch.report import notebook
from greybox_torch.report.tables import print_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from greybox_torch.model import GreyBoxModel

_COLUMNS = ["channel", "unit", "column", "remark"]


@dataclass(frozen=True, eq=False, repr=False)
class CardResult(DraftedFile):
    """``text`` is the card, which belongs to ``path``; ``open`` says what is left to fill in."""

    draft: CardDraft
    path: Path

    @property
    def text(self) -> str:
        """The card, in TOML."""
        return self.draft.text

    @property
    def open(self) -> tuple[str, ...]:
        """What is left to fill in, a line each."""
        return self.draft.open

    @property
    def rows(self) -> list[dict[str, Any]]:
        """A row for every channel: name, unit, column (None where none was found), unit of the file, remark."""
        return [
            {"channel": d.name, "unit": d.unit, "column": d.column, "file_unit": d.file_unit, "remark": d.remark}
            for d in self.draft.channels
        ]

    def __repr__(self) -> str:
        return f"<data card for {', '.join(file.path.name for file in self.draft.files)}>"

    def content(self, folder: Path) -> dict[str, Any]:
        """The draft as JSON. ``time`` is the column of time stamps by its name, a text; by its position from 1 on, a number, where files
        joined over time call it differently; null where there is none.
        """
        clock, runs = self.draft.clock, self.draft.runs
        return {
            "schema": "greybox-card/1",
            "card": str(self.path),
            "time": clock.on_card,
            "date": clock.date or None,
            "time_unit": clock.unit if clock.column is not None else None,
            "sample_time": clock.sample_time,
            "channels": self.rows,
            "files": [
                {"file": str(file.path), "samples": file.samples, "columns": list(file.columns)}
                for file in self.draft.files
            ],
            "runs": [
                {
                    "name": name,
                    "files": [str(file.path) for file in run.files],
                    "columns": own_columns(run, runs[0]),
                    "clocks": own_clocks(run),
                }
                for name, run in zip(names_of(runs), runs, strict=True)
            ],
            "held_out": self.draft.held_out,
            "open": list(self.open),
        }

    def show(self, console: Console) -> None:
        for file in self.draft.files:
            console.print(
                Text(f"{file.path.name}: {file.samples} samples of {', '.join(file.columns)}"), soft_wrap=True
            )
        print_table(console, _COLUMNS, self._table())
        console.print(Text(f"Held out for validation: {self.draft.held_out}"), soft_wrap=True)
        for line in self.open:
            console.print(Text(f"To be filled in: {line}", style="yellow"), soft_wrap=True)

    def plot(self) -> Figure:
        """Every channel that was found, as the files hold it: over time where the sample time is known, else over samples."""
        from greybox_torch.report.channels import plot_channels

        found = {draft.name: draft.column for draft in self.draft.channels if draft.column is not None}
        recordings = [
            Recording.from_arrays(
                run.whole.path.name,
                {name: run.whole.columns[column] for name, column in found.items()},
                sample_time=self.draft.clock.sample_time or 1.0,
            )
            for run in self.draft.runs
            if all(column in run.whole.columns for column in found.values())
        ]
        along = "sample" if self.draft.clock.sample_time is None else ""
        return plot_channels(DataSet(recordings, name=f"For {self.path.name}", held_out_by_default=False), along)

    def _repr_html_(self) -> str:
        told = [notebook.sentence(f"To be filled in: {line}", "found") for line in self.open]
        return notebook.page(repr(self)[1:-1], notebook.table(_COLUMNS, self._table()), *told)

    def _table(self) -> list[list[str | float]]:
        return [[d.name, d.unit, d.column or "", d.remark] for d in self.draft.channels]


@names_checked
def card(
    files: str | PathLike[str] | Iterable[str | PathLike[str]],
    model: GreyBoxModel | str | None = None,
    *,
    path: str | PathLike[str] | None = None,
    sample_time: float | None = None,
) -> CardResult:
    """Look at recordings and draft the data card for them; :meth:`CardResult.save` writes it.

    Args:
        files: the recordings, in the order of the experiments; the last of several, or the last quarter of one, is for validation.
        model: whose inputs and outputs the columns are matched with; an object, or a name as :func:`greybox_torch.load_model` takes it.
        path: of the card; by default `dataset.toml` beside the first file.
        sample_time: in seconds, where no column has time stamps; by default guessed from names such as Ts and fs.

    Raises:
        UserError: a file that cannot be read, or no such model.

    Examples:
        ``card(["steps.csv", "sweep.csv"], Motor()).save()``
    """
    paths = _paths(files)
    place = Path(path) if path is not None else paths[0].parent / USUAL
    if sample_time is not None and not 0.0 < sample_time < float("inf"):
        raise ArgumentError("sample_time", sample_time, "expected seconds, above 0")
    given, name = _model(model, place.parent)
    drafted = draft_card(paths, place.parent, given, name, sample_time)
    if place.suffix != ".toml":
        raise ArgumentError("path", str(place), "expected a file that ends in .toml", option="out")
    return CardResult(drafted, place)


def _paths(files: Any) -> list[Path]:
    paths = [Path(files)] if isinstance(files, str | PathLike) else [Path(file) for file in files]
    if not paths:
        raise ArgumentError("files", [], "expected at least one recording")
    for k, one in enumerate(paths):
        if any(absolute(one) == absolute(other) for other in paths[:k]):
            raise ArgumentError("files", f"{one} twice", "expected each recording once: the last one is for validation")
    return paths


def _model(model: GreyBoxModel | str | None, folder: Path) -> tuple[GreyBoxModel | None, str | None]:
    """The model, and how a card in ``folder`` names it."""
    if model is None:
        return None, None
    from greybox_torch.api.arguments import check_model
    from greybox_torch.systems import load_model, model_reference

    given = load_model(model) if isinstance(model, str) else check_model(model, runs=False)
    file, colon, name = model_reference(given).rpartition(":")
    if not file.endswith(".py"):
        return given, f"{file}{colon}{name}"
    try:
        return given, f"{Path(os.path.relpath(file, absolute(folder))).as_posix()}:{name}"
    except ValueError as error:  # another drive
        raise UserError(f"{file}: {error}; expected a model on the drive of the card") from None
