"""The summary that `greybox fit` prints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rich.console import Console
from rich.text import Text

from greybox_torch.commands.free_runs import print_scores
from greybox_torch.commands.tables import number, print_table
from greybox_torch.commands.task import Task
from greybox_torch.estimate.comparison import Score
from greybox_torch.estimate.fit import FitResult


def print_summary(console: Console, task: Task, found: FitResult, scores: Mapping[str, Sequence[Score]]) -> None:
    """Parameters, start states, how the estimation ended, and the fit of every experiment before and after."""
    console.print(Text(f"{task.data.name}: {task.model.title}", style="bold"))
    console.print(Text("\nParameters", style="bold"))
    _print_parameters(console, found)
    for e, name in enumerate(found.problem.tape.names):
        console.print(Text(f"Initial states of {name}", style="bold"))
        _print_initial(console, found, e)
    statistics = {
        "termination": found.termination.value,
        "iterations": str(found.iterations),
        "evaluations": str(found.evaluations),
        "mean squared error": f"{found.mse:.6g}",
        "final prediction error": f"{found.fpe:.6g}",
        "samples": str(found.samples),
    }
    for name, value in statistics.items():
        console.print(Text(f"{name + ':':24}{value}"), soft_wrap=True)
    _print_warnings(console, found)
    console.print()
    print_scores(console, task.data, dict(scores))
    written = f"Written to {task.folder}: fit.json, model.safetensors, model.json"
    console.print(Text(written), soft_wrap=True)


def _print_parameters(console: Console, found: FitResult) -> None:
    problem = found.problem
    plain, sandwich = found.parameter_deviations(), found.parameter_deviations("sandwich")
    rows = []
    for k, declared in enumerate(problem.model.declared_parameters):
        free = bool(problem.free[k])
        deviations = [_deviation(d[declared.name]) for d in (plain, sandwich)] if free and plain else ["", ""]
        bounds = f"[{number(problem.lower[k])}, {number(problem.upper[k])}]"
        rows.append(
            [
                declared.name,
                declared.description,
                declared.unit,
                float(problem.values[k]),
                *deviations,
                bounds,
                "estimated" if free else "fixed",
            ]
        )
    columns = ["name", "description", "unit", "value", "std", "std\n(coloured)", "bounds", ""]
    print_table(console, columns, rows, prose=["description"])


def _print_initial(console: Console, found: FitResult, experiment: int) -> None:
    problem = found.problem
    plain, sandwich = found.initial_deviations(), found.initial_deviations("sandwich")
    rows = []
    for i, state in enumerate(problem.model.states):
        free = bool(problem.initial_free[i])
        deviations = [_deviation(float(d[experiment, i])) for d in (plain, sandwich)] if free else ["", ""]
        value = float(problem.initial[experiment, i])
        rows.append([state.name, state.description, state.unit, value, *deviations, "estimated" if free else "fixed"])
    columns = ["name", "description", "unit", "value", "std", "std\n(coloured)", ""]
    print_table(console, columns, rows, prose=["description"])


def _deviation(value: float) -> str | float:
    return value if value < float("inf") else "undetermined"


def _print_warnings(console: Console, found: FitResult) -> None:
    problem, plain = found.problem, found.parameter_deviations()
    lost = [name for name, deviation in plain.items() if deviation == float("inf")]
    if lost:
        console.print(
            Text(
                f"The data do not determine {', '.join(lost)}, alone or together: fix one of them, or excite the machine more."
            ),
            style="yellow",
        )
    at_bound = [
        name
        for name, free, value, low, high in zip(
            problem.names, problem.free, problem.values, problem.lower, problem.upper, strict=True
        )
        if free and value in (low, high)
    ]
    if at_bound:
        console.print(
            Text(f"At a bound: {', '.join(at_bound)}; the standard deviations there mean little."), style="yellow"
        )
