"""A checkpoint's model on the data set of a task."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from greybox_torch.checkpoint import Checkpoint, check_same_parameters, load_checkpoint
from greybox_torch.commands.task import Task
from greybox_torch.diagnose.restore import restored_model
from greybox_torch.errors import UserError
from greybox_torch.estimate.problem import Problem, all_starts_free
from greybox_torch.model import GreyBoxModel
from greybox_torch.systems import load_model


def restored(task: Task, path: Path) -> tuple[Task, Problem]:
    """The task with the checkpoint's own model, effects included, and its problem with the checkpoint's values.

    Raises UserError where the checkpoint is damaged, or is not one of the model it names.
    """
    checkpoint = load_checkpoint(path)
    task = _with_own_model(task, checkpoint)
    base = task.model
    if checkpoint.effects:
        task = replace(task, model=_with_effects(path, base, checkpoint.effects))
    check_same_parameters(path, checkpoint, base.title, [p.name for p in task.model.declared_parameters])
    problem = task.problem(values=checkpoint.values)
    return task, all_starts_free(task.data, problem, base) if checkpoint.free_starts else problem


def _with_own_model(task: Task, checkpoint: Checkpoint) -> Task:
    """A model that is not where it was when the checkpoint was written is taken to be the task's, if that has the same name."""
    if checkpoint.model == task.model_name:
        return task
    same, file = checkpoint.title == task.model.title, Path(checkpoint.model.rpartition(":")[0])
    if same and file.suffix == ".py" and not file.exists():
        return task
    data = task.data if same else replace(task.data, parameters={}, initial={})  # the card speaks of another model
    return replace(task, data=data, model=load_model(checkpoint.model), model_name=checkpoint.model)


def _with_effects(path: Path, base: GreyBoxModel, effects: Sequence[Mapping[str, Any]]) -> GreyBoxModel:
    try:
        return restored_model(base, effects)
    except UserError as error:
        raise UserError(f"checkpoint {path}: {error}") from None
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise UserError(f'checkpoint {path}: "effects" are damaged: {type(error).__name__}: {error}') from None
