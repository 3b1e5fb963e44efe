"""Prediction errors of a model: whether they are white, and whether the inputs still explain part of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.text import Text

from greybox_torch.api.arguments import check_experiment
from greybox_torch.api.data_argument import Data
from greybox_torch.api.result import Result
from greybox_torch.api.simulate import START, simulate
from greybox_torch.estimate.residuals import Correlation, Residuals, is_slower
from greybox_torch.evaluation import Evaluation
from greybox_torch.keywords import names_checked
from greybox_torch.model import GreyBoxModel
from greybox_torch.name_lists import listed
from greybox_torch.report import notebook
from greybox_torch.report.tables import print_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FIGURE = "residuals.png"

_EXPLANATION = (
    "Autocorrelation: the largest at lags 1 to 25, near 0 where errors are as random as noise; correlation with an input: the largest at "
    "lags 0 to 25. The bounds are those of one lag; white: no autocorrelation is beyond what chance gives over all lags together."
)

_SLOW = (
    "whether past inputs explain part of them cannot be judged: errors and inputs change so slowly beside the length of the recordings "
    "that chance alone gives any correlation"
)
_NOT_LINEAR = (
    "what is left repeats from sample to sample, and past inputs do not explain it linearly: look at it over time for what is not "
    "recorded, such as a load, or for an effect that follows the motion, such as friction"
)
_DIAGNOSE = " (`greybox diagnose` looks for the latter)"


@dataclass(frozen=True, eq=False, repr=False)
class ResidualResult(Result):
    """What a model's free runs leave of every output in every experiment; ``tests`` hold the errors and their correlations."""

    run: Evaluation
    name: str = START

    @property
    def tests(self) -> tuple[Residuals, ...]:
        """Errors (N,) of every output in every experiment, their whiteness, and their correlation with each input."""
        return self.run.residuals

    @property
    def scores(self) -> list[dict[str, Any]]:
        """A row for every output of every experiment: root mean square error, and every correlation with its 99 % bound."""
        rows = []
        for test, score in zip(self.tests, self.run.comparison.scores, strict=True):
            row = {"experiment": score.experiment, "role": score.role, "output": score.output, "rmse": score.rmse}
            row |= {"unit": test.output.unit, "whiteness": test.whiteness.largest, "bound": test.whiteness.bound}
            for name, found in test.inputs.items():
                row |= {f"correlation with {name}": found.largest, f"bound with {name}": found.bound}
            rows.append(row)
        return rows

    def __repr__(self) -> str:
        return f"<{self._title}>"

    def content(self, folder: Path) -> dict[str, Any]:
        return {
            "schema": "greybox-residuals/1",
            "dataset": self.run.data.name,
            "model": {"name": self.name, "model": self.run.model_name},
            "residuals": [
                _row_json(test, s.rmse) for test, s in zip(self.tests, self.run.comparison.scores, strict=True)
            ],
            "figure": str(folder / FIGURE),
        }

    def show(self, console: Console) -> None:
        console.print(Text(self._title, style="bold"))
        print_table(console, *self._table(), prose=["experiment"])
        for line in self._notes:
            console.print(Text(line), soft_wrap=True)

    def files(self, folder: Path) -> dict[Path, str | bytes]:
        return {folder / FIGURE: notebook.png(self.plot())}

    def plot(self, experiment: str | None = None) -> Figure:
        """Errors over time, their autocorrelation, and their correlation with the inputs, of all experiments or of one.

        Raises:
            ArgumentError: there is no such experiment.
        """
        from greybox_torch.report.residuals import plot_residuals  # matplotlib takes half a second

        if experiment is None:
            return plot_residuals(self.tests, self._title)
        check_experiment(self.run.data, experiment)
        own = [test for test in self.tests if test.recording.name == experiment]
        return plot_residuals(own, f"{self._title}, {experiment}")

    def _repr_html_(self) -> str:
        notes = (notebook.sentence(line) for line in self._notes)
        shown = notebook.picture(self.plot(), "errors over time, their autocorrelation and correlation with the inputs")
        return notebook.page(self._title, notebook.table(*self._table()), *notes, shown)

    @property
    def _notes(self) -> tuple[str, ...]:
        slower = list(dict.fromkeys(test.output.name for test in self.tests if is_slower(test.errors)))
        own = [f"{listed(slower)}: sampled more slowly than the rest, lags are in its own samples."] if slower else []
        return _EXPLANATION, *own, read(self.tests, diagnosed=bool(self.run.problem.model.effects_told()))

    @property
    def _title(self) -> str:
        return f"{self.run.data.name}: residuals of {self.run.problem.model.title}, {self.name}"

    def _table(self) -> tuple[list[str], list[list[str | float]]]:
        columns = ["experiment", "role", "output", "rmse", "unit", "largest auto-\ncorrelation", "99 %\nbound"]
        columns += [
            heading for name in self.tests[0].inputs for heading in (f"correlation\nwith {name}", "99 %\nbound")
        ]
        white = ["yes" if test.whiteness.within_chance else "no" for test in self.tests]
        rows = []
        for test, row, is_white in zip(self.tests, self.scores, white, strict=True):
            still = [name for name, found in test.inputs.items() if not found.defined]
            none = {f"{what} with {name}": "-" for name in still for what in ("correlation", "bound")}
            rows.append([*(row | none).values(), is_white])
        return [*columns, "white"], rows


@names_checked
def residuals(
    model: GreyBoxModel | Any, data: Data, *, name: str | None = None, device: str = "cpu", precision: str = "double"
) -> ResidualResult:
    """Test the errors of a model's free runs: whether they are white, and whether the inputs still explain part of them.

    Args:
        model: with the values that it holds, as for :func:`greybox_torch.simulate`; a result of a fit or a diagnosis stands for its model.
        data: the experiments, from :func:`greybox_torch.load_dataset` or made with ``DataSet(…)``; or their card by path.
        name: what the model is called in the result; by default as for :func:`greybox_torch.simulate`.
        device: "cpu", "cuda" or "cuda:N".
        precision: "double" or "single".

    Raises:
        UserError: model and data do not fit, or an argument is at fault.
        NumericalError: the simulation overflows in every experiment.
    """
    simulated = simulate(model, data, name=name, device=device, precision=precision)
    return ResidualResult(simulated.run, simulated.name)


def read(tests: Sequence[Residuals], *, diagnosed: bool = False) -> str:
    """What the tests of all rows show together, and what that means.

    Args:
        diagnosed: whether the model has effects that a diagnosis or a training has attached.
    """
    coloured = sum(not test.whiteness.within_chance for test in tests)
    driven = [[n for n, found in test.inputs.items() if not found.within_chance] for test in tests]
    names = listed(list(dict.fromkeys(name for row in driven for name in row)))
    rows = (
        f"{coloured} of {len(tests)} rows {'is' if coloured == 1 else 'are'} not white"
        if coloured
        else "All rows are white"
    )
    if names:
        count = sum(map(bool, driven))
        more = f"{count} {'correlates' if count == 1 else 'correlate'} with {names} by more than chance gives over all lags"
        return f"{rows}, and {more}: that part a better model can remove."
    bounds = [found.bound for test in tests for found in test.inputs.values()]
    if bounds and min(bounds) >= 1.0:
        return f"{rows}; {_SLOW}."
    inputs = ", and none correlates with an input by more than chance gives over all lags" if bounds else ""
    if not coloured:
        return f"{rows}{inputs}: nothing is left that these tests show."
    if not bounds:
        return f"{rows}: what is left repeats from sample to sample, so that a better model can remove part of it."
    return f"{rows}{inputs}: {_NOT_LINEAR}{'' if diagnosed else _DIAGNOSE}."


def _row_json(test: Residuals, rmse: float) -> dict[str, Any]:
    result = {
        "experiment": test.recording.name,
        "role": test.recording.role,
        "output": test.output.name,
        "rmse": rmse,
        "whiteness": _correlation_json(test.whiteness),
        "input_correlation": None,
    }
    if test.inputs:
        worst = max(test.inputs, key=lambda name: test.inputs[name].largest / test.inputs[name].bound)
        by_input = {name: _correlation_json(correlation) for name, correlation in test.inputs.items()}
        result["input_correlation"] = {"input": worst, **by_input[worst], "inputs": by_input}
    return result


def _correlation_json(correlation: Correlation) -> dict[str, Any]:
    return {
        "value": correlation.largest,
        "bound": correlation.bound,
        "lags_outside": correlation.outside,
        "lags": correlation.tested,
    }
