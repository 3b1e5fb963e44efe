"""Comparing models on a data set."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.text import Text

from greybox_torch.api.arguments import check_model, check_precision
from greybox_torch.api.data_argument import Data, check_data
from greybox_torch.api.free_runs import Runs, figure_files, file_stems, free_runs_json, plot_free_runs
from greybox_torch.api.plain_arguments import check_device
from greybox_torch.api.result import Result
from greybox_torch.api.scores import print_scores, print_substeps, score_rows, score_table
from greybox_torch.api.simulate import SimulationResult
from greybox_torch.api.start_states import Fits, begun_far, better_before, first_tenth, own_fits
from greybox_torch.data import DataSet
from greybox_torch.errors import ArgumentError, Kind
from greybox_torch.evaluation import evaluated
from greybox_torch.keywords import names_checked
from greybox_torch.model import GreyBoxModel
from greybox_torch.report import notebook
from greybox_torch.restored import card_of, load, load_beside
from greybox_torch.systems import load_model

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class ComparisonResult(Result):
    """Free runs of several models on the same experiments: ``result["fit"]["sweep"]["speed"]`` is an output (N,) of one of them."""

    data: DataSet
    runs: Runs
    own: Mapping[str, Fits] = field(default_factory=dict)
    """Of models that were estimated from these recordings, their fits with the start states of that estimate."""

    @property
    def scores(self) -> list[dict[str, Any]]:
        """A row for every output of every experiment simulated by every model: fit in %, root mean square error in the output's unit."""
        return score_rows(self.data, self._scores)

    @property
    def warnings(self) -> list[str]:
        """Of every model whose simulation overflows or diverges where that is, and what avoids it; models with states that begin far from
        what measures them; and models that follow an experiment far better with the start states of their estimate.
        """
        overflows = [f"{name}: {run.overflow}" for name, run in self.runs.items() if run.overflow is not None]
        diverging = [f"{name}: {line}" for name, run in self.runs.items() for line in run.diverging]
        far = [f"{name}: {line}" for name, line in begun_far(self.runs).items()]
        return [*overflows, *diverging, *far, *better_before(self.runs, self.own)]

    def __getitem__(self, model: str) -> SimulationResult:
        if model not in self.runs:
            raise KeyError(f"no model {model!r}; there are: {', '.join(self)}")
        return SimulationResult(self.runs[model], model)

    def __iter__(self) -> Iterator[str]:
        return iter(self.runs)

    def __len__(self) -> int:
        return len(self.runs)

    def __repr__(self) -> str:
        return f"<comparison on {self.data.name}: {', '.join(self)}>"

    def content(self, folder: Path) -> dict[str, Any]:
        figures = [str(folder / f"{stem}.png") for stem in file_stems(self.data, "comparison")]
        return {**free_runs_json(self.data, self.runs), "warnings": self.warnings, "figures": figures}

    def show(self, console: Console) -> None:
        console.print(Text(self.data.name, style="bold"))
        print_scores(console, self.data, self._scores)
        for line in first_tenth(self.runs):
            console.print(Text(line), soft_wrap=True)
        for line in self.warnings:
            console.print(Text(line, style="yellow"), soft_wrap=True)
        for name, run in self.runs.items():
            print_substeps(console, run.substeps, name)

    def files(self, folder: Path) -> dict[Path, str | bytes]:
        """A figure of every experiment."""
        return figure_files(folder, self.data, self.runs, "comparison")

    def plot(self, experiment: str | None = None) -> Figure:
        """Simulated against measured, of all experiments or of one."""
        return plot_free_runs(self.data, self.runs, experiment)

    def _repr_html_(self) -> str:
        return notebook.page(
            self.data.name,
            notebook.table(*score_table(self.data, self._scores)),
            *(notebook.sentence(line) for line in (*first_tenth(self.runs), *self.warnings)),
            notebook.picture(self.plot(), "outputs over time, measured and simulated by each model"),
        )

    @property
    def _scores(self) -> dict[str, Any]:
        return {name: run.comparison.scores for name, run in self.runs.items()}


@names_checked
def compare(
    data: Data,
    models: Mapping[str, GreyBoxModel | str | PathLike[str] | Any],
    *,
    device: str = "cpu",
    precision: str = "double",
) -> ComparisonResult:
    """Simulate every experiment with several models, each from start states estimated on the experiment's first tenth.

    A model whose simulation overflows is reported so, beside the others.

    Args:
        data: the experiments, from :func:`greybox_torch.load_dataset` or made with ``DataSet(…)``; or their card by path.
        models: by the name they are to have: models with the values that they hold, results of a fit or a diagnosis, or checkpoints by
            path. What the data set's card says of parameters and start states is meant for the first of them, and for others of its kind.
        device: "cpu", "cuda" or "cuda:N".
        precision: "double" or "single".

    Raises:
        UserError: a model does not fit the data, a checkpoint is damaged, or an argument is at fault.

    Examples:
        ``compare(data, {"start": Motor(), "fit": fitted, "earlier": "results/model"}).plot()``
    """
    device, precision = check_device(device), check_precision(precision)
    if isinstance(models, DataSet | str | PathLike):
        raise ArgumentError("models", Kind.of(models), 'expected the data first: compare(data, {"start": Motor()})')
    data = check_data(data)
    if not isinstance(models, Mapping) or not models:
        kind = Kind("none") if isinstance(models, Mapping) else Kind.of(models)
        raise ArgumentError("models", kind, 'expected models by name, such as {"start": Motor(), "fit": result}')
    at_hand = {name: check_model(given) for name, given in models.items() if not isinstance(given, str | PathLike)}
    own = next(iter(at_hand.values()), None) or (load_model(data.model) if data.model is not None else None)
    runs = {}
    for name, given in models.items():
        if not isinstance(given, str | PathLike):
            model, its_data = at_hand[name], card_of(data, own or at_hand[name], at_hand[name])
        else:
            model, its_data = (load(given), data) if own is None else load_beside(given, own, data)
        runs[name] = evaluated(its_data, model, device=device, precision=precision)
    return ComparisonResult(data, runs, {name: own_fits(given, data) for name, given in models.items()})
