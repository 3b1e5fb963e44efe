"""`greybox residuals`: prediction errors, whether they are white, and whether the inputs still explain part of them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.text import Text

from greybox_torch.checkpoint import checkpoint_name
from greybox_torch.commands.free_runs import START, ModelRun, free_run, refuse_overflow
from greybox_torch.commands.options import Options
from greybox_torch.commands.tables import print_table
from greybox_torch.commands.task import load_task
from greybox_torch.estimate.residuals import Correlation, Residuals
from greybox_torch.files import replacing
from greybox_torch.report.residuals import plot_residuals

_EXPLANATION = (
    "whiteness: largest autocorrelation at lags 1 to 25; correlation with an input: largest at lags 0 to 25.",
    "Above the bound, something repeatable is left in the residual. What correlates with the input a better model can remove.",
)


def run(dataset: Path, checkpoint: Path | None, options: Options) -> None:
    """Prints the statistics of the free run's errors, with the start values or those of a checkpoint, and draws them.

    Raises UserError where the input is at fault, NumericalError where the simulation overflows.
    """
    task = load_task(dataset, options)
    simulated = free_run(task, checkpoint, START if checkpoint is None else checkpoint_name(checkpoint))
    refuse_overflow(task, simulated)
    rows = simulated.residuals
    figure = task.folder / "residuals.png"
    title = f"{task.data.name}: residuals of {task.model.title}, {simulated.name}"
    with replacing(figure) as temporary:
        plot_residuals(rows, title).savefig(temporary)
    result = [_row_json(row, simulated, e) for e, row in enumerate(rows)]
    _print(options, title, rows, result, figure)
    options.print_json(
        {
            "schema": "greybox-residuals/1",
            "dataset": task.data.name,
            "model": {"name": simulated.name, "model": simulated.model_name},
            "residuals": result,
            "figure": str(figure),
        }
    )


def _row_json(row: Residuals, simulated: ModelRun, index: int) -> dict[str, Any]:
    result = {
        "experiment": row.recording.name,
        "role": row.recording.role,
        "output": row.output.name,
        "rmse": simulated.comparison.scores[index].rmse,
        "whiteness": _correlation_json(row.whiteness),
        "input_correlation": None,
    }
    if row.inputs:
        worst = max(row.inputs, key=lambda name: row.inputs[name].largest / row.inputs[name].bound)
        by_input = {name: _correlation_json(correlation) for name, correlation in row.inputs.items()}
        result["input_correlation"] = {"input": worst, **by_input[worst], "inputs": by_input}
    return result


def _correlation_json(correlation: Correlation) -> dict[str, Any]:
    return {
        "value": correlation.largest,
        "bound": correlation.bound,
        "lags_outside": correlation.outside,
        "lags": correlation.tested,
    }


def _print(options: Options, title: str, rows: Sequence[Residuals], result: list[dict[str, Any]], figure: Path) -> None:
    console = options.console()
    console.print(Text(title, style="bold"))
    inputs = list(rows[0].inputs)
    columns = ["experiment", "role", "output", "rmse", "unit", "whiteness", "99 %\nbound"]
    columns += [heading for name in inputs for heading in (f"correlation\nwith {name}", "99 %\nbound")]
    lines = []
    for row, numbers in zip(rows, result, strict=True):
        correlations = [c for k in (row.whiteness, *row.inputs.values()) for c in (k.largest, k.bound)]
        lines.append(
            [row.recording.name, row.recording.role, row.output.name, numbers["rmse"], row.output.unit, *correlations]
        )
    print_table(console, columns, lines, prose=["experiment"])
    for line in _EXPLANATION:
        console.print(line, soft_wrap=True)
    console.print(Text(f"Figure: {figure}"), soft_wrap=True)
