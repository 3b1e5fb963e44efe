"""A model taken home: C, a module of torch, an FMU."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.text import Text

from greybox_torch.api.arguments import check_data, check_model
from greybox_torch.api.result import Result
from greybox_torch.data import DataSet
from greybox_torch.errors import ArgumentError, did_you_mean
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.simulators import simulator_for
from greybox_torch.exporting.c_source import c_files
from greybox_torch.exporting.exported import ExportedModel, exported
from greybox_torch.exporting.fmu import fmu_files
from greybox_torch.exporting.torch_module import torch_files
from greybox_torch.model import GreyBoxModel
from greybox_torch.report import notebook
from greybox_torch.report.tables import print_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WRITERS: dict[str, Callable[[ExportedModel], Mapping[str, str | bytes]]] = {
    "c": c_files,
    "torch": torch_files,
    "fmu": fmu_files,
}
"""What a model can be exported to: functions that give the contents of files by name."""

_COLUMNS = ["kind", "name", "unit", "value", "description"]


@dataclass(frozen=True, eq=False, repr=False)
class ExportResult(Result):
    """``model`` as ``contents``, files by name; ``exported`` says what is in them."""

    model: GreyBoxModel
    to: str
    exported: ExportedModel
    contents: dict[str, str | bytes]

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
            "files": [str(folder / name) for name in self.contents],
            "variables": self.rows,
        }

    def show(self, console: Console) -> None:
        console.print(
            Text(f"{self.exported.title} as {self.to}, steps of at most {self.exported.step:g} s"), soft_wrap=True
        )
        print_table(console, _COLUMNS, self._table(), prose=["description"])

    def files(self, folder: Path) -> dict[Path, str | bytes]:
        return {folder / name: content for name, content in self.contents.items()}

    def plot(self) -> Figure:
        """Which part of the model without its effects moves which output."""
        from greybox_torch.api.check import check

        return check(self.model).plot()

    def _repr_html_(self) -> str:
        return notebook.page(repr(self)[1:-1], notebook.table(_COLUMNS, self._table()))

    def _table(self) -> list[list[str | float]]:
        return [
            [
                row["kind"],
                row["name"],
                row["unit"],
                "" if row["kind"] in ("input", "output") else f"{row['value']:.6g}",
                row["description"],
            ]
            for row in self.rows
        ]


def export(
    model: GreyBoxModel | Any,
    *,
    to: str,
    data: DataSet | None = None,
    name: str | None = None,
    step: float | None = None,
) -> ExportResult:
    """The model with the values that it holds, and its effects, each with a switch, in a form that needs nothing of this package.

    Args:
        model: an object, or the result of a fit or a diagnosis.
        to: "c" (a header, a source, an example), "torch" (a module), "fmu" (FMI 2.0 and 3.0, co-simulation).
        data: recordings from which the integration step is taken, and how inputs run between samples.
        name: of functions and files; by default made from the model's.
        step: largest integration step in seconds; by default what ``data`` need, else the sample time that effects were found with.

    Raises:
        UserError: equations that have no compiled form, a dead time without a longest value, or an argument is at fault.

    Examples:
        ``export(found, to="c", data=data).save("motor_in_c")``
    """
    if to not in WRITERS:
        raise ArgumentError("to", to, f"expected one of {', '.join(WRITERS)}{did_you_mean(str(to), WRITERS)}")
    given = check_model(model)
    hold = "zoh"
    if data is not None:
        hold = check_data(data).hold
        step = _needed(given, data) if step is None else step
    made = exported(given, name, step, hold)
    return ExportResult(given, to, made, dict(WRITERS[to](made)))


def _needed(model: GreyBoxModel, data: DataSet) -> float:
    """The integration step, in seconds, that simulating ``data`` takes."""
    problem = make_problem(data, model, data.recordings)
    sample_time = min(recording.sample_time for recording in data.recordings)
    return sample_time / simulator_for(problem, tangents=False).substeps
