"""`greybox train`: the hybrid of a physical model and a network at one of its ports."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

from greybox_torch.api.arguments import check_estimation
from greybox_torch.api.scores import Scores
from greybox_torch.checkpoint import Checkpoint, checkpoint_files
from greybox_torch.commands.options import Options
from greybox_torch.commands.progress import training
from greybox_torch.commands.task import Task, load_task
from greybox_torch.commands.train_figure import figure_file
from greybox_torch.commands.train_json import result_json
from greybox_torch.commands.train_summary import print_summary, written_files
from greybox_torch.estimate.comparison import Score, compare
from greybox_torch.estimate.fit import FitResult
from greybox_torch.estimate.problem import Problem, all_starts_free, make_problem, problem_for
from greybox_torch.estimate.simulators import simulator_for
from greybox_torch.files import json_text, write_all
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.stored import attachment_json
from greybox_torch.simulation.simulator import SimulationOptions, Simulator
from greybox_torch.systems import model_reference
from greybox_torch.train import (
    Explanation,
    Hybrid,
    Report,
    Trained,
    TrainingSettings,
    explain,
    train_hybrid,
)
from greybox_torch.train.tensorboard import tensorboard_log

RESULT, MODEL, SNAPSHOT, LOG = "train.json", "model", "training.safetensors", "tensorboard"
NAMED, FIGURE = "named", "learned.png"
"""The model with a law in the network's place, and what the network has learned."""


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
    explain: bool = True
    ensemble: int = 1


def run(dataset: Path, options: Options, choices: Choices) -> None:
    """Trains on the experiments of role "estimation", judges on all; writes train.json and the checkpoint `model`, all or nothing.

    While it runs it keeps `training.safetensors`, which --resume takes up; that is left where it is.

    Raises UserError where the input is at fault, NumericalError where even short stretches of the simulation overflow.
    """
    task = load_task(dataset, options)
    check_estimation(task.data)
    settings = TrainingSettings(seed=options.seed, **choices.training)
    with ExitStack() as together:
        together.enter_context(_interruptible(task.folder / SNAPSHOT))
        log = together.enter_context(tensorboard_log(task.folder / LOG)) if choices.tensorboard else None
        tell = together.enter_context(training(f"training a hybrid of {task.data.name}"))

        def progress(report: Report) -> None:
            tell(report.stage, report.share, report.line)
            if log is not None and report.last is not None:
                log(report.last)

        train = partial(
            train_hybrid,
            task.data,
            task.model,
            net=choices.net,
            port=choices.port,
            signals=choices.signals,
            network=dict(choices.network),
            device=task.device,
            progress=progress,
        )
        found = train(settings=settings, snapshot=task.folder / SNAPSHOT, resume=choices.resume)
        explained = _explained(found, choices, train, lambda what: tell(what, 1.0, ""))
        tell("scoring", 1.0, "")
        scores = _scores(task, found, explained)
    result = result_json(task, found, scores, explained)
    with figure_file(task.folder / FIGURE, found, explained):
        write_all(
            {
                task.folder / RESULT: json_text(result),
                **checkpoint_files(task.folder / MODEL, _checkpoint(task, found, result["fit"])),
                **_named_files(task, found, explained, result["fit"]),
            }
        )
    console = options.console()
    print_summary(console, task, found, scores, explained)
    options.print_written(console, task.folder, written_files(explained))
    options.print_json(json_text(result))


def _explained(
    found: Trained, choices: Choices, train: Callable[..., Trained], told: Callable[[str], None]
) -> Explanation | None:
    """What the network stands for; the trainings of an ensemble share the physics."""
    if not choices.explain:
        return None
    others = []
    for seed in range(found.settings.seed + 1, found.settings.seed + choices.ensemble):
        told(f"training with seed {seed}")
        others.append(train(settings=replace(found.settings, seed=seed), physics=found.shared_physics))
    return explain(found, others, told=told)


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


def _scores(task: Task, found: Trained, explained: Explanation | None) -> Scores:
    """Start values, physics, hybrid and the law that replaces its network, if one does, on all experiments; start states from the first
    tenth of each.
    """
    start = make_problem(task.data, task.model, task.data.recordings)
    plain = simulator_for(start, SimulationOptions(task.device), tangents=False)
    free = all_starts_free(task.data, start)
    refit = free.with_values(found.physics.problem.values)
    recordings = task.data.recordings
    result = {
        "start": compare(start, recordings, plain).scores,
        "refit": compare(refit, recordings, plain.with_substeps(found.physics.substeps)).scores,
        "augmented": _scores_of(task, start, found.result),
    }
    named = None if explained is None else explained.result
    return result if named is None else {**result, "named": _scores_of(task, start, named)}


def _scores_of(task: Task, start: Problem, found: FitResult) -> tuple[Score, ...]:
    model = found.problem.model
    problem = all_starts_free(task.data, problem_for(start, model, {})).with_values(found.problem.values)
    simulator = Simulator.of(model, (), SimulationOptions(task.device, substeps=found.substeps))
    return compare(problem, task.data.recordings, simulator).scores


def _named_files(
    task: Task, found: Trained, explained: Explanation | None, figures: list[dict[str, Any]]
) -> dict[Path, str | bytes]:
    """The checkpoint of the model with the law instead of the network, where one was recommended."""
    if explained is None or explained.term is None or explained.result is None:
        return {}
    attachments = (*found.hybrid.attachments[:-1], explained.term.attachment)
    return checkpoint_files(
        task.folder / NAMED, _checkpoint_of(task, explained.result, found.hybrid, attachments, figures)
    )


def _checkpoint(task: Task, found: Trained, figures: list[dict[str, Any]]) -> Checkpoint:
    return _checkpoint_of(task, found.result, found.hybrid, found.hybrid.attachments, figures)


def _checkpoint_of(
    task: Task,
    result: FitResult,
    hybrid: Hybrid,
    attachments: Sequence[Attachment],
    figures: list[dict[str, Any]],
) -> Checkpoint:
    problem = result.problem
    return Checkpoint(
        model=model_reference(task.model),
        title=task.model.title,
        values=dict(zip(problem.names, np.asarray(problem.values, dtype=float).tolist(), strict=True)),
        units={p.name: p.unit for p in problem.model.declared_parameters},
        effects=[attachment_json(a, hybrid.surroundings[a.port]) for a in attachments],
        free_starts=True,
        dataset=task.data.sha256,
        figures=figures,
    )
