"""A checkpoint's model on a data set: the way back from the two files to something that simulates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from greybox_torch.checkpoint import Checkpoint, check_same_parameters, check_same_units, load_checkpoint
from greybox_torch.data import DataSet
from greybox_torch.errors import UserError
from greybox_torch.estimate.problem import Problem, all_starts_free, make_problem
from greybox_torch.mechanisms.stored import restored_model
from greybox_torch.model import GreyBoxModel
from greybox_torch.rates import rates_at
from greybox_torch.systems import load_model


@dataclass(frozen=True)
class SavedModel:
    """A checkpoint's ``model``, effects included, without any recordings; ``base`` is the same without the effects."""

    checkpoint: Checkpoint
    base: GreyBoxModel
    model: GreyBoxModel

    def rates(self, states: Mapping[str, Any], inputs: Mapping[str, Any] | None = None) -> dict[str, np.ndarray]:
        """The rates of all states at given states and inputs, see :func:`greybox_torch.rates.rates_at`."""
        return rates_at(self.model, self.checkpoint.values, states, inputs)


def load_saved_model(path: str | PathLike[str], model: GreyBoxModel | None = None) -> SavedModel:
    """The model of the checkpoint at ``path``, with its effects.

    Args:
        model: the plain model, loaded already; by default the one that the checkpoint names.

    Raises:
        UserError: the checkpoint is damaged, or is not one of the model it names.
    """
    path = Path(path)
    checkpoint = load_checkpoint(path)
    base = load_model(checkpoint.model) if model is None else model
    augmented = _with_effects(path, base, checkpoint.effects) if checkpoint.effects else base
    check_same_parameters(path, checkpoint, base.title, [p.name for p in augmented.declared_parameters])
    check_same_units(path, checkpoint, base.title, {p.name: p.unit for p in base.declared_parameters})
    return SavedModel(checkpoint, base, augmented)


@dataclass(frozen=True)
class Restored:
    """``problem`` is that of the checkpoint's model, effects included, on all recordings of ``data``, with the checkpoint's values.

    ``data`` is without what its card says of a model other than the checkpoint's; ``model_name`` is how to load the model.
    """

    data: DataSet
    model_name: str
    problem: Problem


def restored(data: DataSet, path: str | PathLike[str], model: GreyBoxModel, model_name: str) -> Restored:
    """The checkpoint at ``path`` on ``data``; ``model`` is what data and user ask for, and stands in where the checkpoint's has moved.

    Raises UserError where the checkpoint is damaged, or is not one of the model it names.
    """
    data, base, model_name = _own_model(data, load_checkpoint(path), model, model_name)
    saved = load_saved_model(path, base)
    problem = make_problem(data, saved.model, data.recordings)
    problem = problem.with_values(np.array([saved.checkpoint.values[name] for name in problem.names]))
    _check_admissible(Path(path), problem)
    if saved.checkpoint.free_starts:
        problem = all_starts_free(data, problem)
    return Restored(data, model_name, problem)


def _own_model(
    data: DataSet, checkpoint: Checkpoint, model: GreyBoxModel, model_name: str
) -> tuple[DataSet, GreyBoxModel, str]:
    """A model that is not where it was when the checkpoint was written is taken to be the one at hand, if that has the same name."""
    if checkpoint.model == model_name:
        return data, model, model_name
    same, file = checkpoint.title == model.title, Path(checkpoint.model.rpartition(":")[0])
    if same and file.suffix == ".py" and not file.exists():
        return data, model, model_name
    data = data if same else replace(data, parameters={}, initial={})  # the card speaks of another model
    return data, load_model(checkpoint.model), checkpoint.model


def _with_effects(path: Path, base: GreyBoxModel, effects: Sequence[Mapping[str, Any]]) -> GreyBoxModel:
    try:
        return restored_model(base, effects)
    except UserError as error:
        raise UserError(f"checkpoint {path}: {error}") from None
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise UserError(f'checkpoint {path}: "effects" are damaged: {type(error).__name__}: {error}') from None


def _check_admissible(path: Path, problem: Problem) -> None:
    if not problem.admissible(problem.values):
        title = problem.model.title
        raise UserError(
            f"checkpoint {path}: its values break a constraint of model {title}; expected values that it allows"
        )
