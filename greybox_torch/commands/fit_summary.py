"""The summary that `greybox fit` prints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rich.console import Console
from rich.text import Text

from greybox_torch.commands.free_runs import print_scores, print_substeps
from greybox_torch.commands.tables import number, print_table
from greybox_torch.commands.task import Task
from greybox_torch.estimate.comparison import Score
from greybox_torch.estimate.fit import FitResult
from greybox_torch.estimate.profile import LEVEL, Profile
from greybox_torch.estimate.termination import Termination


def print_summary(
    console: Console,
    task: Task,
    found: FitResult,
    scores: Mapping[str, Sequence[Score]],
    profiles: Mapping[str, Profile],
) -> None:
    """Parameters, start states, how the estimation ended, profiles, and the fit of every experiment before and after."""
    console.print(Text(f"{task.data.name}: {task.model.title}", style="bold"))
    console.print(Text("\nParameters", style="bold"))
    _print_parameters(console, found)
    for e, name in enumerate(found.problem.records.names):
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
    print_substeps(console, found.substeps)
    _print_correlations(console, found)
    _print_warnings(console, found)
    _print_profiles(console, profiles)
    console.print()
    print_scores(console, task.data, dict(scores))
    figures = [f"profile_{name}.png" for name in profiles]
    written = f"Written to {task.folder}: {', '.join(['fit.json', 'model.safetensors', 'model.json', *figures])}"
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


def _print_correlations(console: Console, found: FitResult) -> None:
    pairs = found.correlation.strong_pairs() if found.correlation else []
    if pairs:
        told = ", ".join(f"{a} and {b} {value:+.3f}" for a, b, value in pairs)
        console.print(Text(f"Estimates that move together (correlation): {told}"), soft_wrap=True)


def _print_warnings(console: Console, found: FitResult) -> None:
    lost = [name for name, deviation in found.parameter_deviations().items() if deviation == float("inf")]
    lines = []
    if lost:
        lines.append(
            f"The data do not determine {', '.join(lost)}, alone or together: fix one of them, or excite the machine more."
        )
    lines += [f"{weakness.sentence}." for weakness in found.identifiability]
    for note in found.notes:
        if note.kind is Termination.at_bound:
            lines.append(f"At a bound: {note.detail}; the standard deviations there mean little.")
    for line in lines:
        console.print(Text(line, style="yellow"), soft_wrap=True)


def _print_profiles(console: Console, profiles: Mapping[str, Profile]) -> None:
    if not profiles:
        return
    console.print(Text(f"Profile likelihood, {100 * LEVEL:g} % intervals", style="bold"))
    for one in profiles.values():
        console.print(Text(f"{one.sentence} (allowing for coloured residuals by {one.colour:.3g})"), soft_wrap=True)
