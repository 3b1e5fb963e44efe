"""What a check of a model found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.text import Text

from greybox_torch.api.result import Result
from greybox_torch.checking.examine import Examination
from greybox_torch.checking.finding import Finding
from greybox_torch.report import notebook
from greybox_torch.report.tables import print_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_STYLE = {"error": "bold red", "warning": "yellow", "note": "dim"}
_COLUMNS = ["kind", "name", "unit", "value", "moves"]


@dataclass(frozen=True, eq=False, repr=False)
class CheckResult(Result):
    """``findings`` say where something is wrong, what it is, and what to write instead, errors first; ``usable`` is
    False where one is an error, of the model or of the card.

    ``compiled`` is False where equations work but have no compiled form, which makes a diagnosis far too slow. ``values``: of parameters,
    where a data card was given; those declared otherwise. ``with_data``: whether one was given, and ``card`` its file, empty where the data
    are from memory.
    """

    name: str
    examined: Examination
    findings: tuple[Finding, ...]
    values: Mapping[str, float] = field(default_factory=dict)
    with_data: bool = False
    card: str = ""

    @property
    def usable(self) -> bool:
        """Whether nothing that was found is an error, of the model or of the card."""
        return not any(finding.level == "error" for finding in self.findings)

    @property
    def compiled(self) -> bool:
        """Whether the equations have a compiled form."""
        return self.examined.compiled

    @property
    def sentence(self) -> str:
        """The result in one sentence."""
        counts = {level: sum(f.level == level for f in self.findings) for level in ("error", "warning", "note")}
        told = ", ".join(f"{count} {level}{'s' * (count != 1)}" for level, count in counts.items() if count)
        if not self.usable:
            return f"{self._at_fault}: {told}."
        both = (
            f"Channels, parameters and start states of {self.card or 'the data set'} fit {self.name}, which can be used"
        )
        usable = both if self.with_data else f"{self.name} can be used"
        if told:
            return f"{usable}: {told}."
        nothing = (
            "nothing is wrong that shows without a simulation"
            if self.with_data
            else "nothing is wrong with it that shows without data"
        )
        return f"{usable}; {nothing}."

    @property
    def _at_fault(self) -> str:
        """Which cannot be used: the model, or the card, which is compared with a model that can."""
        errors = [finding for finding in self.findings if finding.level == "error"]
        if any(finding.topic != "card" for finding in errors):
            return f"{self.name} cannot be used"
        card = "the data set" if errors[0].file is None else errors[0].file.name
        return f"{card} does not fit {self.name}, which itself can be used"

    @property
    def rows(self) -> list[dict[str, Any]]:
        """A row for every state, input, parameter and port: kind, name, unit, value, and the outputs that it moves (None: unknown)."""
        model, moved = self.examined.model, self.examined.influence
        if model is None:
            return []
        values = {**{p.name: p.value for p in model.declared_parameters}, **self.values}
        items = {
            "state": model.states,
            "input": model.inputs,
            "parameter": model.declared_parameters,
            "port": model.ports,
        }
        return [
            {
                "kind": kind,
                "name": item.name,
                "unit": getattr(item, "unit", ""),
                "value": values[item.name] if kind == "parameter" else None,
                "moves": None if moved is None else moved.outputs(kind, i, model),
            }
            for kind, of in items.items()
            for i, item in enumerate(of)
        ]

    def __repr__(self) -> str:
        return f"<check: {self.sentence}>"

    def content(self, folder: Path) -> dict[str, Any]:
        return {
            "schema": "greybox-check/1",
            "model": self.name,
            "usable": self.usable,
            "compiled": self.compiled,
            "findings": [
                {
                    "level": f.level,
                    "topic": f.topic,
                    "file": None if f.file is None else str(f.file),
                    "line": f.line,
                    "found": f.found,
                    "write": f.write,
                }
                for f in self.findings
            ],
            "parts": self.rows,
        }

    def show(self, console: Console) -> None:
        if self.rows:
            print_table(console, _COLUMNS, self._table())
        for finding in self.findings:
            told = f"{finding.level}: {finding.place}{finding.found}"
            console.print(Text(told, style=_STYLE[finding.level]), soft_wrap=True)
            console.print(Text(f"    write: {finding.write}"), soft_wrap=True)
        console.print(Text(self.sentence, style="bold"), soft_wrap=True)

    def files(self, folder: Path) -> dict[Path, str | bytes]:
        """Nothing: a check is looked at."""
        return {}

    def plot(self) -> Figure:
        """Which part moves which output, as a picture."""
        from greybox_torch.report.influence import plot_influence  # matplotlib takes half a second

        outputs = [] if self.examined.model is None else [o.name for o in self.examined.model.outputs]
        return plot_influence(self.rows, outputs, self.name)

    def _repr_html_(self) -> str:
        told = [notebook.sentence(f"{f.level}: {f}", "found" if f.level == "error" else "note") for f in self.findings]
        table = notebook.table(_COLUMNS, self._table()) if self.rows else ""
        return notebook.page(self.sentence, *told, table)

    def _table(self) -> list[list[str | float]]:
        return [
            [
                row["kind"],
                row["name"],
                row["unit"],
                "" if row["value"] is None else float(row["value"]),
                "not known" if row["moves"] is None else ", ".join(row["moves"]) or "nothing",
            ]
            for row in self.rows
        ]
