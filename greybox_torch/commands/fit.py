"""`greybox fit`: estimates the free parameters and start states."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from greybox_torch.checkpoint import Checkpoint, save_checkpoint
from greybox_torch.commands.fit_summary import print_summary
from greybox_torch.commands.free_runs import scores_json
from greybox_torch.commands.options import Options
from greybox_torch.commands.task import Task, check_estimation, load_task
from greybox_torch.estimate.comparison import Score, compare
from greybox_torch.estimate.fit import FitResult, fit
from greybox_torch.estimate.termination import Termination
from greybox_torch.files import json_text, write_text
from greybox_torch.simulate.stepper import Stepper, make_stepper
from greybox_torch.simulate.substeps import choose_substeps

Scores = dict[str, tuple[Score, ...]]
"""Rows by "start" and "refit", in the order of the data set's experiments."""


def run(dataset: Path, options: Options) -> None:
    """Estimates on the experiments of role "estimation", judges on all; writes fit.json and the checkpoint `model`.

    Raises UserError where the input is at fault, NumericalError where even short stretches of the simulation overflow.
    """
    began = time.perf_counter()
    task = load_task(dataset, options)
    check_estimation(dataset, task.data)
    problem = task.problem(task.data.estimation())
    stepper = make_stepper(task.model, problem.free_names, device=task.device)
    found = fit(problem, stepper=stepper, device=task.device, progress=_progress(Console(stderr=True, highlight=False)))
    scores = _scores(task, found, stepper)
    result = result_json(found, scores, time.perf_counter() - began)
    result |= {
        "dataset": task.data.name,
        "model": task.model_name,
        "held_out_by_default": task.data.held_out_by_default,
    }
    stem = task.folder / "model"
    result["checkpoint"] = str(stem)
    save_checkpoint(stem, _checkpoint(task, found, result["fit"]))
    write_text(task.folder / "fit.json", json_text(result))
    print_summary(options.console(), task, found, scores)
    options.print_json(result)


def result_json(found: FitResult, scores: Scores, seconds: float) -> dict[str, Any]:
    """The result as `fit --json` prints it."""
    problem = found.problem
    return {
        "schema": "greybox-fit/1",
        "seconds": seconds,
        "parameters": _parameters_json(found),
        "initial": {name: _initial_json(found, e) for e, name in enumerate(problem.tape.names)},
        "fit": [
            {
                **{k: v for k, v in start.items() if k not in ("fit", "rmse")},
                "start": _numbers(start),
                "refit": _numbers(refit),
            }
            for start, refit in zip(scores_json(scores["start"]), scores_json(scores["refit"]), strict=True)
        ],
        "statistics": {
            "mse": found.mse,
            "fpe": found.fpe,
            "samples": found.samples,
            "iterations": found.iterations,
            "evaluations": found.evaluations,
            "status": status(found.termination),
            "termination": found.termination.value,
        },
    }


def status(termination: Termination) -> str:
    """One word on how it ended: "converged", or what kept it from that."""
    both = (Termination.converged, Termination.small_step)
    return "converged" if termination in both else termination.name


def _parameters_json(found: FitResult) -> dict[str, Any]:
    problem = found.problem
    plain, sandwich = found.parameter_deviations(), found.parameter_deviations("sandwich")
    result = {}
    for k, declared in enumerate(problem.model.declared_parameters):
        result[declared.name] = {
            "value": float(problem.values[k]),
            "std": plain.get(declared.name, 0.0),
            "std_sandwich": sandwich.get(declared.name, 0.0),
            "unit": declared.unit,
            "fixed": not bool(problem.free[k]),
            "lower": float(problem.lower[k]),
            "upper": float(problem.upper[k]),
            "description": declared.description,
        }
    return result


def _initial_json(found: FitResult, experiment: int) -> dict[str, Any]:
    problem = found.problem
    plain, sandwich = found.initial_deviations(), found.initial_deviations("sandwich")
    return {
        state.name: {
            "value": float(problem.initial[experiment, i]),
            "std": float(plain[experiment, i]),
            "std_sandwich": float(sandwich[experiment, i]),
            "unit": state.unit,
            "fixed": not bool(problem.initial_free[i]),
        }
        for i, state in enumerate(problem.model.states)
    }


def _numbers(row: dict[str, Any]) -> dict[str, float]:
    return {"fit": row["fit"], "rmse": row["rmse"]}


def _scores(task: Task, found: FitResult, stepper: Stepper) -> Scores:
    """Start and refitted values on all experiments.

    Start states come from the first tenth of each, but for the refit on the experiments it was estimated on: there they are its own.
    """
    recordings = task.data.recordings
    start = task.problem()
    substeps = choose_substeps(start.driving_tape, stepper, start.values, start.initial) or 1
    before = compare(start, recordings, stepper, substeps=substeps)
    refit = start.with_values(found.problem.values)
    everywhere = compare(refit, recordings, stepper, substeps=found.substeps)
    own = compare(found.problem, task.data.estimation(), stepper, substeps=found.substeps, estimate_starts=False)
    fitted = {(score.experiment, score.output): score for score in own.scores}
    after = tuple(fitted.get((score.experiment, score.output), score) for score in everywhere.scores)
    return {"start": before.scores, "refit": after}


def _checkpoint(task: Task, found: FitResult, figures: list[dict[str, Any]]) -> Checkpoint:
    values = dict(zip(found.problem.names, np.asarray(found.problem.values, dtype=float).tolist(), strict=True))
    return Checkpoint(
        model=task.model_name,
        title=task.model.title,
        values=values,
        units={p.name: p.unit for p in task.model.declared_parameters},
        dataset=task.data.sha256,
        figures=figures,
    )


def _progress(console: Console) -> Callable[[str, int, float], None]:
    def line(stage: str, iteration: int, mean_square: float) -> None:
        console.print(f"{stage}, iteration {iteration}: mean squared error {mean_square:.6g}")

    return line
