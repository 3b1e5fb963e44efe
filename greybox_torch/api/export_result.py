"""What an export gives: files of a model, or a snippet for a simulator of jointed bodies."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.text import Text

from greybox_torch.api.result import Result
from greybox_torch.exporting.exported import ExportedModel
from greybox_torch.exporting.joints.snippet import Snippet
from greybox_torch.model import GreyBoxModel
from greybox_torch.report import notebook
from greybox_torch.report.tables import print_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_COLUMNS = ["kind", "name", "unit", "value", "description"]
DIGITS = 6


@dataclass(frozen=True, eq=False, repr=False)
class ExportResult(Result):
    """``model`` as ``contents``, files by name; ``exported`` says what is in them, ``step_from`` what the step is where recordings have
    not said which one they need.
    """

    model: GreyBoxModel
    to: str
    exported: ExportedModel
    contents: dict[str, str | bytes]
    step_from: str = ""

    @property
    def warnings(self) -> list[str]:
        """What was taken without being asked of recordings."""
        if not self.step_from:
            return []
        return [
            f"without recordings (--dataset, in Python data=) nothing says how small steps have to be: {self.exported.step:g} s is "
            f"{self.step_from}, and inputs are held between samples. With recordings they are as in greybox simulate"
        ]

    @property
    def rows(self) -> list[dict[str, Any]]:
        """A row for every state (value: its start), input, output, parameter and switch of an effect."""
        kinds = {"state": self.exported.states, "input": self.exported.inputs, "output": self.exported.outputs}
        rows = [(kind, v) for kind, of in kinds.items() for v in of]
        rows += [("switch" if v.is_switch else "parameter", v) for v in self.exported.parameters]
        return [
            {"kind": kind, "name": v.name, "unit": v.unit, "value": v.value, "description": v.description}
            for kind, v in rows
        ]

    def __repr__(self) -> str:
        return f"<{self.exported.title} as {self.to}: {', '.join(self.contents)}>"

    def content(self, folder: Path) -> dict[str, Any]:
        return {
            "schema": "greybox-export/1",
            "model": self.exported.title,
            "to": self.to,
            "name": self.exported.identifier,
            "step": self.exported.step,
            "warnings": self.warnings,
            "files": [str(folder / name) for name in self.contents],
            "variables": self.rows,
        }

    def show(self, console: Console) -> None:
        console.print(
            Text(f"{self.exported.title} as {self.to}, steps of at most {self.exported.step:g} s"), soft_wrap=True
        )
        print_table(console, _COLUMNS, self._table(), prose=["description"], digits=DIGITS)
        for found in self.warnings:
            console.print(Text(f"warning: {found}.", style="yellow"), soft_wrap=True)

    def files(self, folder: Path) -> dict[Path, str | bytes]:
        return {folder / name: content for name, content in self.contents.items()}

    def plot(self) -> Figure:
        """Which part of the model without its effects moves which output."""
        return _influence(self.model)

    def _repr_html_(self) -> str:
        told = (notebook.sentence(f"warning: {found}.") for found in self.warnings)
        return notebook.page(repr(self)[1:-1], notebook.table(_COLUMNS, self._table(), DIGITS), *told)

    def _table(self) -> list[list[str | float]]:
        return [
            [
                row["kind"],
                row["name"],
                row["unit"],
                "" if row["kind"] in ("input", "output") else float(row["value"]),
                row["description"],
            ]
            for row in self.rows
        ]


@dataclass(frozen=True, eq=False, repr=False)
class SnippetResult(Result):
    """What the effects of ``model`` are in the language ``to``: ``snippet`` has its text and what could not be said in it."""

    model: GreyBoxModel
    to: str
    snippet: Snippet

    @property
    def rows(self) -> list[dict[str, Any]]:
        """A row for everything that is not in the text, or is to be known about it: the effect, and why."""
        return [{"effect": one.effect, "why": one.why} for one in self.snippet.unsaid]

    def __repr__(self) -> str:
        return f"<{self.model.title} as {self.to}: {self.snippet.name}>"

    def content(self, folder: Path) -> dict[str, Any]:
        return {
            "schema": "greybox-snippet/1",
            "model": self.model.title,
            "to": self.to,
            "files": [str(folder / self.snippet.name)],
            "text": self.snippet.text,
            "elements": [
                {"element": one.element, "name": one.name, "attributes": dict(one.attributes)}
                for one in self.snippet.said
            ],
            "sentence": self.sentence,
            "not_said": self.rows,
        }

    @property
    def sentence(self) -> str:
        """Where nothing could be said in the format: that; "" elsewhere."""
        if self.snippet.said:
            return ""
        return (
            f"Nothing of the effects of {self.model.title} can be expressed in {self.to}: the file holds remarks alone. Expected are "
            "effects of joints, tendons and actuators; c, torch and fmu hold the whole model."
        )

    def show(self, console: Console) -> None:
        console.print(Text(self.snippet.text), soft_wrap=True)
        if self.sentence:
            console.print(Text(self.sentence, style="bold"), soft_wrap=True)
        if self.snippet.unsaid:
            console.print(Text("What is not in it, or is to be known about it:"))
        for one in self.snippet.unsaid:
            console.print(Text(f"- {one.effect}: {one.why}"), soft_wrap=True)

    def files(self, folder: Path) -> dict[Path, str | bytes]:
        return {folder / self.snippet.name: self.snippet.text}

    def plot(self) -> Figure:
        """Which part of the model without its effects moves which output."""
        return _influence(self.model)

    def _repr_html_(self) -> str:
        rows = [[one.effect, one.why] for one in self.snippet.unsaid]
        return notebook.page(
            repr(self)[1:-1], notebook.verbatim(self.snippet.text), notebook.table(["effect", "not said"], rows)
        )


def _influence(model: GreyBoxModel) -> Figure:
    from greybox_torch.api.check import check

    return check(model).plot()
