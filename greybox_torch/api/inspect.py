"""Looking at a data set: extent, spread and gaps of every channel, and whether a model fits it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import Console
from rich.text import Text

from greybox_torch.api.data_argument import Data, check_data
from greybox_torch.api.data_warnings import all_warnings
from greybox_torch.api.notes_of_recordings import told_once
from greybox_torch.api.result import HELD_OUT, Result
from greybox_torch.checking.constant_channels import rests
from greybox_torch.data import DataSet
from greybox_torch.data.data_warning import DataWarning
from greybox_torch.data.own_samples import missing_samples, own_samples, own_step
from greybox_torch.keywords import names_checked
from greybox_torch.name_lists import brief
from greybox_torch.report import notebook
from greybox_torch.report.tables import print_table
from greybox_torch.report.time_axis import time_unit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from greybox_torch.data import Recording
    from greybox_torch.model import GreyBoxModel

FIGURE = "channels.png"
DIGITS = 4
_COLUMNS = ["channel", "unit", "samples", "sample time [s]", "min", "max", "std", "missing"]


@dataclass(frozen=True, eq=False, repr=False)
class InspectionResult(Result):
    """What is in a data set; ``model`` is the name of the model that it was checked against, and ``checked`` the model.

    Both are None where there is none.
    """

    data: DataSet
    model: str | None = None
    checked: GreyBoxModel | None = None

    @property
    def rows(self) -> list[dict[str, Any]]:
        """A row for every channel of every experiment, values in the channel's unit, times in seconds."""
        return [
            {"experiment": recording.name, "role": recording.role, "channel": name, **entry}
            for recording in self.data.recordings
            for name, entry in self._channels(recording).items()
        ]

    @cached_property
    def warnings(self) -> list[DataWarning]:
        """What may be wrong with the data although they can be read."""
        return all_warnings(self.data, self.checked)

    def __repr__(self) -> str:
        return f"<inspection of {self.data.name}: {', '.join(r.name for r in self.data.recordings)}>"

    def content(self, folder: Path) -> dict[str, Any]:
        return {
            "schema": "greybox-inspect/1",
            "dataset": self.data.name,
            "held_out_by_default": self.data.held_out_by_default,
            "experiments": [
                {
                    "name": recording.name,
                    "role": recording.role,
                    "notes": list(recording.notes),
                    "channels": self._channels(recording),
                }
                for recording in self.data.recordings
            ],
            "model": self.model,
            "warnings": [str(found) for found in self.warnings],
            "figure": str(folder / FIGURE),
        }

    def show(self, console: Console) -> None:
        console.print(Text(self.data.name, style="bold"))
        for recording in self.data.recordings:
            heading = f"{recording.name} ({recording.role})"
            console.print(Text.assemble("\n", (heading, "bold"), f": {_extent(recording)}"))
            print_table(console, _COLUMNS, self._table(recording), digits=DIGITS)
        for line in self._notes():
            console.print(Text(line), soft_wrap=True)

    def files(self, folder: Path) -> dict[Path, str | bytes]:
        return {folder / FIGURE: notebook.png(self.plot())}

    def plot(self) -> Figure:
        """Every channel of every experiment over time."""
        from greybox_torch.report.channels import plot_channels  # matplotlib takes half a second

        return plot_channels(self.data)

    def _repr_html_(self) -> str:
        parts = []
        for recording in self.data.recordings:
            parts.append(notebook.sentence(f"{recording.name} ({recording.role}): {_extent(recording)}"))
            parts.append(notebook.table(_COLUMNS, self._table(recording), DIGITS))
        parts += [notebook.sentence(line) for line in self._notes()]
        return notebook.page(self.data.name, *parts, notebook.picture(self.plot(), "every channel over time"))

    def _channels(self, recording: Recording) -> dict[str, dict[str, Any]]:
        return {
            name: {
                "samples": int(own_samples(recording, name).sum()),
                "sample_time": own_step(recording, name),
                "min": float(np.nanmin(values)),
                "max": float(np.nanmax(values)),
                "std": 0.0 if rests(recording, name) else float(np.nanstd(values)),
                "missing": int(missing_samples(recording, name).sum()),
                "unit": self.data.channels[name].unit,
            }
            for name, values in recording.signals.items()
        }

    def _table(self, recording: Recording) -> list[list[str | float]]:
        rows: list[list[str | float]] = []
        for name, entry in self._channels(recording).items():
            numbers = [entry[key] for key in ("samples", "sample_time", "min", "max", "std", "missing")]
            rows.append([name, entry["unit"], *numbers])
        return rows

    def _notes(self) -> list[str]:
        notes = told_once(self.data.recordings)
        notes += [f"warning: {self.data.place()}: {found}" for found in self.warnings]
        notes += self._without_unit()
        notes += [HELD_OUT] if self.data.held_out_by_default else []
        if self.model is not None:
            notes.append(f"Channels, parameters and start states fit the model {self.model}.")
        return notes

    def _without_unit(self) -> list[str]:
        """What units the model takes channels in that have none: in Python nothing else says it."""
        signals = [] if self.checked is None else [*self.checked.inputs, *self.checked.outputs]
        taken = [
            f"{s.name} as {s.unit}" for s in signals if s.unit not in ("", "1") and not self.data.channels[s.name].unit
        ]
        return [f"Channels without a unit are taken in the model's units: {', '.join(taken)}."] if taken else []


@names_checked
def inspect(data: Data, model: GreyBoxModel | str | None = None) -> InspectionResult:
    """Look at the channels of a data set, and check it against a model.

    Args:
        data: from :func:`greybox_torch.load_dataset`, or made with ``DataSet(…)``; or a card by path.
        model: an object, or a name as :func:`greybox_torch.load_model` takes it; by default the card's. Without
            a model only the data are looked at.

    Raises:
        UserError: channels, parameters or start states are not the model's, or an argument is at fault.
    """
    data = check_data(data)
    wanted = data.model if model is None else model
    if wanted is None:
        return InspectionResult(data)
    from greybox_torch.api.arguments import check_model  # torch takes seconds
    from greybox_torch.estimate.problem import make_problem
    from greybox_torch.systems import load_model, model_reference

    given = load_model(wanted) if isinstance(wanted, str) else check_model(wanted, runs=False)
    make_problem(data, given, data.recordings)
    return InspectionResult(data, wanted if isinstance(wanted, str) else model_reference(given), given)


def _extent(recording: Recording) -> str:
    """Where the samples are from, where they are from files, and how long they take. Rows are those of the first file, or of
    all one after the other.
    """
    files = [] if recording.source is None else [recording.source.name, *(file.name for file in recording.further)]
    file = f"{brief(files)}, rows = {list(recording.rows)}, " if files else ""
    seconds = float(recording.time[-1] - recording.time[0])
    unit = time_unit(seconds)
    longer = f" ({seconds / unit.seconds:.3g} {unit.symbol})" if unit.seconds > 1.0 else ""
    return f"{file}{seconds:.6g} s{longer}"
