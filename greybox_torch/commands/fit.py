"""`greybox fit`: estimates the free parameters and start states."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.text import Text

from greybox_torch.checkpoint import Checkpoint, save_checkpoint
from greybox_torch.commands.fit_json import Scores, identifiability_json, profile_json, result_json
from greybox_torch.commands.fit_summary import print_summary
from greybox_torch.commands.options import Options
from greybox_torch.commands.task import Task, check_estimation, load_task
from greybox_torch.estimate.comparison import compare
from greybox_torch.estimate.fit import FitResult, fit
from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.identifiability import Unidentifiable, identifiability
from greybox_torch.estimate.levenberg_marquardt import DEFAULT
from greybox_torch.estimate.precision import settings_for
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.profile import SETTINGS, Profile, check_profiled, profile
from greybox_torch.files import json_text, replacing, write_text
from greybox_torch.simulation.stepper import Stepper, make_stepper
from greybox_torch.simulation.substeps import choose_substeps


def run(dataset: Path, options: Options, profiled: Sequence[str] = (), starts: int | None = None) -> None:
    """Estimates on the experiments of role "estimation", judges on all; writes fit.json, the checkpoint `model`, figures of profiles.

    Args:
        profiled: names of free parameters whose profile likelihood is wanted too.
        starts: how many start values to try; by default those given, and many more where these turn out poor.

    Raises UserError where the input is at fault, NumericalError where even short stretches of the simulation overflow.
    """
    began = time.perf_counter()
    task = load_task(dataset, options)
    check_estimation(dataset, task.data)
    problem = task.problem(task.data.estimation())
    check_profiled(profiled, problem.free_names, problem.names, task.model.title)
    stepper = make_stepper(task.model, problem.free_names, device=task.device, precision=task.precision)
    log = Console(stderr=True, highlight=False)
    weaknesses = _at_start(task, problem, stepper)
    for weakness in weaknesses:
        log.print(Text(f"At the start values: {weakness.sentence}.", style="yellow"), soft_wrap=True)
    found = fit(
        problem,
        stepper=stepper,
        settings=settings_for(task.precision, DEFAULT),
        device=task.device,
        precision=task.precision,
        progress=_progress(log),
        starts=starts,
        seed=options.seed,
    )
    profiles = _profiles(task, found, stepper, profiled, log)
    scores = _scores(task, found, stepper)
    stem = task.folder / "model"
    result = result_json(found, scores, time.perf_counter() - began) | {
        "identifiability": identifiability_json(weaknesses, found.identifiability),
        "profiles": {name: profile_json(one) for name, one in profiles.items()},
        "precision": task.precision,
        "dataset": task.data.name,
        "model": task.model_name,
        "held_out_by_default": task.data.held_out_by_default,
        "checkpoint": str(stem),
    }
    with _figures(task, profiles):
        save_checkpoint(stem, _checkpoint(task, found, result["fit"]))
        write_text(task.folder / "fit.json", json_text(result))
    print_summary(options.console(), task, found, scores, profiles)
    options.print_json(result)


def _at_start(task: Task, problem: Problem, stepper: Stepper) -> tuple[Unidentifiable, ...]:
    """What the data do not determine, as far as the start values tell."""
    substeps = choose_substeps(problem.driving_records, stepper, problem.values, problem.initial) or 1
    start = FreeRun(problem, stepper, substeps)
    return identifiability(start, start.start, precision=task.precision)


def _profiles(
    task: Task, found: FitResult, stepper: Stepper, profiled: Sequence[str], log: Console
) -> dict[str, Profile]:
    profiles = {}
    for name in dict.fromkeys(profiled):
        profiles[name] = profile(found, stepper, name, settings=settings_for(task.precision, SETTINGS))
        log.print(Text(f"profile of {name}: {len(profiles[name].values)} points"), soft_wrap=True)
    return profiles


@contextmanager
def _figures(task: Task, profiles: Mapping[str, Profile]) -> Iterator[None]:
    """Draws the profiles; the figures are in their place once the block ends without an error."""
    if profiles:
        from greybox_torch.report.profile import plot_profile  # matplotlib takes half a second

    with ExitStack() as together:
        for name, one in profiles.items():
            temporary = together.enter_context(replacing(task.folder / f"profile_{name}.png"))
            plot_profile(one, f"{task.data.name}: profile of {name}").savefig(temporary)
        yield


def _scores(task: Task, found: FitResult, stepper: Stepper) -> Scores:
    """Start and refitted values on all experiments.

    Start states come from the first tenth of each, but for the refit on the experiments it was estimated on: there they are its own.
    """
    recordings = task.data.recordings
    start = task.problem()
    substeps = choose_substeps(start.driving_records, stepper, start.values, start.initial) or 1
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
