"""Simulating a model on a data set."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import Console
from rich.text import Text

from greybox_torch.api.arguments import check_model, check_precision
from greybox_torch.api.data_argument import Data, check_data
from greybox_torch.api.free_runs import figure_files, file_stems, free_runs_json, plot_free_runs
from greybox_torch.api.plain_arguments import check_device
from greybox_torch.api.result import Result
from greybox_torch.api.scores import print_scores, print_substeps, score_rows, score_table
from greybox_torch.api.start_states import begun_far, first_tenth
from greybox_torch.data import DataSet
from greybox_torch.data.steps import steps_of
from greybox_torch.errors import NumericalError
from greybox_torch.estimate.comparison import AUGMENTED, START
from greybox_torch.evaluation import Evaluation, evaluated
from greybox_torch.keywords import names_checked
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.copies import copy_holding
from greybox_torch.report import notebook

if TYPE_CHECKING:
    from matplotlib.figure import Figure

HELD = "held values"
"""What scores call a model that holds values: whether they were estimated it does not tell."""

OPPOSITE = -0.8
"""Correlation of simulated with measured below which an output is told to move the other way: noise and wrong parameters leave less."""


class Outputs(dict[str, np.ndarray]):
    """Simulated outputs (N,) by name; another name is a KeyError that lists them."""

    def __missing__(self, name: str) -> np.ndarray:
        raise KeyError(f"no output {name!r}; there are: {', '.join(self)}")


@dataclass(frozen=True, eq=False, repr=False)
class SimulationResult(Result):
    """Free runs of a model on all experiments: ``result["sweep"]["speed"]`` is a simulated output (N,), in its unit.

    ``run`` holds what else is known of them: start states, residuals, static laws.
    """

    run: Evaluation
    name: str = START

    @property
    def data(self) -> DataSet:
        """What was simulated."""
        return self.run.data

    @cached_property
    def model(self) -> GreyBoxModel:
        """A copy of the model, holding the values that it was simulated with."""
        return copy_holding(self.run.problem.model, self.run.values)

    @property
    def scores(self) -> list[dict[str, Any]]:
        """A row for every output of every experiment: fit in %, root mean square error in the output's unit."""
        return score_rows(self.data, {self.name: self.run.comparison.scores})

    @property
    def initial(self) -> dict[str, dict[str, float]]:
        """The start states by experiment and state, in the states' units."""
        return self.run.initial

    def __getitem__(self, experiment: str) -> dict[str, np.ndarray]:
        if experiment not in self.run.simulated:
            raise KeyError(f"no experiment {experiment!r}; there are: {', '.join(self)}")
        values = self.run.simulated[experiment]
        return Outputs({output.name: values[:, k] for k, output in enumerate(self.run.problem.model.outputs)})

    def __iter__(self) -> Iterator[str]:
        return iter(self.run.simulated)

    def __len__(self) -> int:
        return len(self.run.simulated)

    @cached_property
    def warnings(self) -> list[str]:
        """Experiments whose simulation overflows or diverges, and outputs that move opposite to what was measured, in every experiment: a
        sign is wrong on the card or in the model; and states that begin far from what measures them.
        """
        told = [*([] if self.run.overflow is None else [self.run.overflow]), *self.run.diverging]
        told += begun_far({self.name: self.run}).values()
        for name in (output.name for output in self.run.problem.model.outputs):
            found = [_correlation(self.data.recordings[e].signals[name], self[run][name]) for e, run in enumerate(self)]
            known = [one for one in found if np.isfinite(one)]
            if known and max(known) < OPPOSITE:
                told.append(
                    f"{name}: the simulation moves opposite to the measurement in every experiment (correlation {max(known):.2f}). "
                    "Check the sign of this channel on the card (scale = -1.0 reverses it) and in the model"
                )
        return told

    def __repr__(self) -> str:
        return f"<simulation of {self.run.problem.model.title} on {self.data.name}: {', '.join(self)}>"

    def content(self, folder: Path) -> dict[str, Any]:
        stems = file_stems(self.data, "simulated")
        paths = {
            "tables": [str(folder / f"{stem}.csv") for stem in stems],
            "figures": [str(folder / f"{stem}.png") for stem in stems],
        }
        return {**free_runs_json(self.data, {self.name: self.run}), "warnings": self.warnings, **paths}

    def show(self, console: Console) -> None:
        effects, held = self.model.effects_told(), self.run.problem.model.held_values()
        told = (
            f"with {', '.join(effects)}"
            if effects
            else f"with {'the values that it holds' if held else 'its start values'}"
        )
        console.print(Text(f"{self._title} {told}", style="bold"))
        print_scores(console, self.data, {self.name: self.run.comparison.scores})
        for line in first_tenth({self.name: self.run}):
            console.print(Text(line), soft_wrap=True)
        print_substeps(console, self.run.substeps)
        for found in self.warnings:
            console.print(Text(f"warning: {found}.", style="yellow"), soft_wrap=True)

    def files(self, folder: Path) -> dict[Path, str | bytes]:
        """A CSV file of an experiment: time in seconds from its start, and every output measured and simulated; and a figure of each."""
        tables = {folder / f"{stem}.csv": self._table(e) for e, stem in enumerate(file_stems(self.data, "simulated"))}
        return {**tables, **figure_files(folder, self.data, {self.name: self.run}, "simulated")}

    def plot(self, experiment: str | None = None) -> Figure:
        """Simulated against measured, of all experiments or of one."""
        return plot_free_runs(self.data, {self.name: self.run}, experiment)

    def _repr_html_(self) -> str:
        scores = {self.name: self.run.comparison.scores}
        begun = first_tenth({self.name: self.run})
        told = map(notebook.sentence, (*begun, *(f"warning: {found}." for found in self.warnings)))
        shown = notebook.picture(self.plot(), "simulated and measured outputs over time")
        return notebook.page(self._title, notebook.table(*score_table(self.data, scores)), *told, shown)

    @property
    def _title(self) -> str:
        return f"{self.data.name}: {self.run.problem.model.title}"

    def _table(self, experiment: int) -> bytes:
        recording, names = self.data.recordings[experiment], [o.name for o in self.run.problem.model.outputs]
        columns = [_since_the_start(recording.time)]
        for k, name in enumerate(names):
            columns += [recording.signals[name], self.run.comparison.simulated[experiment][:, k]]
        header = ",".join(["time", *[f"{name}_{what}" for name in names for what in ("measured", "simulated")]])
        buffer = BytesIO()
        digits = ["%.12g", *["%.10g"] * (len(columns) - 1)]
        np.savetxt(buffer, np.column_stack(columns), fmt=digits, delimiter=",", header=header, comments="")
        return buffer.getvalue()


def _since_the_start(time: np.ndarray) -> np.ndarray:
    """Time stamps (N,) in s from the first one, in evenly spaced steps where floats alone made them uneven, and in no more digits than
    the stamps hold.
    """
    held = int(-np.log10(np.spacing(np.abs(time).max())))
    return np.round(np.append(0.0, np.cumsum(steps_of(time))), min(held + 1, 12))


@np.errstate(all="ignore")
def _correlation(measured: np.ndarray, simulated: np.ndarray) -> float:
    """Of two signals (N,), where both are known; NaN where one of them is constant; NaN or zero where it cannot be squared."""
    known = np.isfinite(measured) & np.isfinite(simulated)
    if known.sum() < 2 or min(np.ptp(measured[known]), np.ptp(simulated[known])) == 0:
        return float("nan")
    return float(np.corrcoef(measured[known], simulated[known])[0, 1])


@names_checked
def simulate(
    model: GreyBoxModel | Any, data: Data, *, name: str | None = None, device: str = "cpu", precision: str = "double"
) -> SimulationResult:
    """Simulate every experiment in free run, from start states estimated on its first tenth.

    Args:
        model: used with the values that it holds: those set by ``set_values()``, else the start values of the data set's card, else the
            declared ones. The result of a fit or a diagnosis stands for its model.
        data: the experiments, from :func:`greybox_torch.load_dataset` or made with ``DataSet(…)``; or their card by path.
        name: what the model is called in the result; by default "refit" for the result of a fit, "augmented" for those of ``diagnose`` and
            ``train`` and for a model with effects, "held values" for one that holds some (``fit.model``, or after ``set_values()``), else
            "start".
        device: "cpu", "cuda" or "cuda:N".
        precision: "double" or "single".

    Raises:
        UserError: model and data do not fit, or an argument is at fault.
        NumericalError: the simulation overflows in every experiment.

    Examples:
        ``simulate(Motor(), data)["sweep"]["speed"]``
    """
    given = check_model(model)
    run = evaluated(check_data(data), given, device=check_device(device), precision=check_precision(precision))
    if len(run.lost) == len(run.comparison.experiments):
        refuse_overflow(run)
    return SimulationResult(run, name or called(model))


def called(model: GreyBoxModel | Any) -> str:
    """What scores call a model, or the result that stands for it, where nobody gives it a name."""
    if isinstance(model, GreyBoxModel):
        return AUGMENTED if model.effects_told() else HELD if model.held_values() else START
    return getattr(model, "stage", START)


def refuse_overflow(run: Evaluation) -> None:
    """Raises NumericalError, saying where, if a free run is not finite."""
    if run.overflow is not None:
        raise NumericalError(f"simulating {run.problem.model.title}: {run.overflow}")
