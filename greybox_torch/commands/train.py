"""`greybox train`: the hybrid of a physical model and a network at one of its ports."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from greybox_torch.checkpoint import Checkpoint, checkpoint_files
from greybox_torch.commands.options import Options
from greybox_torch.commands.progress import training
from greybox_torch.commands.task import Task, check_estimation, load_task
from greybox_torch.commands.train_json import Scores, result_json
from greybox_torch.commands.train_summary import print_summary
from greybox_torch.diagnose.restore import attachment_json
from greybox_torch.estimate.comparison import compare
from greybox_torch.estimate.problem import all_starts_free, problem_for
from greybox_torch.files import json_text, write_all
from greybox_torch.simulate.stepper import make_stepper
from greybox_torch.simulate.substeps import choose_substeps
from greybox_torch.train import Report, Trained, TrainingSettings, train_hybrid
from greybox_torch.train.tensorboard import tensorboard_log

RESULT, MODEL, SNAPSHOT, LOG = "train.json", "model", "training.safetensors", "tensorboard"


@dataclass(frozen=True)
class Choices:
    """What the user asked for: which network reads which signals at which port, and how it is trained."""

    net: str = "friction"
    port: str | None = None
    signals: Sequence[str] = ()
    network: Mapping[str, Any] = field(default_factory=dict)
    training: Mapping[str, Any] = field(default_factory=dict)
    resume: bool = False
    tensorboard: bool = False


def run(dataset: Path, options: Options, choices: Choices) -> None:
    """Trains on the experiments of role "estimation", judges on all; writes train.json and the checkpoint `model`, all or nothing.

    While it runs it keeps `training.safetensors`, which --resume takes up; that is left where it is.

    Raises UserError where the input is at fault, NumericalError where even short stretches of the simulation overflow.
    """
    task = load_task(dataset, options)
    check_estimation(dataset, task.data)
    settings = TrainingSettings(seed=options.seed, **choices.training)
    with ExitStack() as together:
        together.enter_context(_interruptible(task.folder / SNAPSHOT))
        log = together.enter_context(tensorboard_log(task.folder / LOG)) if choices.tensorboard else None
        tell = together.enter_context(training(f"training a hybrid of {task.data.name}"))

        def progress(report: Report) -> None:
            tell(report.stage, report.share, report.line)
            if log is not None and report.last is not None:
                log(report.last)

        found = train_hybrid(
            task.data,
            task.model,
            net=choices.net,
            port=choices.port,
            signals=choices.signals,
            network=dict(choices.network),
            settings=settings,
            device=task.device,
            progress=progress,
            snapshot=task.folder / SNAPSHOT,
            resume=choices.resume,
        )
        tell("scoring", 1.0, "")
        scores = _scores(task, found)
    result = result_json(task, found, scores)
    write_all(
        {
            task.folder / RESULT: json_text(result),
            **checkpoint_files(task.folder / MODEL, _checkpoint(task, found, result["fit"])),
        }
    )
    print_summary(options.console(), task, found, scores)
    options.print_json(result)


@contextmanager
def _interruptible(snapshot: Path) -> Iterator[None]:
    """Says how to go on where the user stops a training."""
    try:
        yield
    except KeyboardInterrupt:
        if snapshot.is_file():
            Console(stderr=True, highlight=False).print(
                f"stopped; the same command with --resume goes on from {snapshot}"
            )
        raise


def _scores(task: Task, found: Trained) -> Scores:
    """Start values, physics and hybrid on all experiments, start states from the first tenth of each."""
    start = task.problem()
    plain = make_stepper(task.model, (), device=task.device)
    substeps = choose_substeps(start.driving_tape, plain, start.values, start.initial) or 1
    free = all_starts_free(task.data, start)
    refit = free.with_values(found.physics.problem.values)
    model = found.result.problem.model
    hybrid = all_starts_free(task.data, problem_for(start, model, {}), task.model)
    hybrid = hybrid.with_values(found.result.problem.values)
    recordings = task.data.recordings
    return {
        "start": compare(start, recordings, plain, substeps=substeps).scores,
        "refit": compare(refit, recordings, plain, substeps=found.physics.substeps).scores,
        "augmented": compare(
            hybrid, recordings, make_stepper(model, (), device=task.device), substeps=found.result.substeps
        ).scores,
    }


def _checkpoint(task: Task, found: Trained, figures: list[dict[str, Any]]) -> Checkpoint:
    problem, hybrid = found.result.problem, found.hybrid
    return Checkpoint(
        model=task.model_name,
        title=task.model.title,
        values=dict(zip(problem.names, np.asarray(problem.values, dtype=float).tolist(), strict=True)),
        units={p.name: p.unit for p in problem.model.declared_parameters},
        effects=[attachment_json(a, hybrid.surroundings[a.port]) for a in hybrid.attachments],
        free_starts=True,
        dataset=task.data.sha256,
        figures=figures,
    )
