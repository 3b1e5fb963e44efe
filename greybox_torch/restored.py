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
from greybox_torch.systems import BUILT_IN, load_model


@dataclass(frozen=True)
class SavedModel:
    """A checkpoint's ``model``, effects included, without any recordings; ``base`` is the same without the effects."""

    checkpoint: Checkpoint
    base: GreyBoxModel
    model: GreyBoxModel

    def rates(self, states: Mapping[str, Any], inputs: Mapping[str, Any] | None = None) -> dict[str, np.ndarray]:
        """The rates of all states at given states and inputs, see :func:`greybox_torch.rates.rates_at`."""
        return rates_at(self.model, self.checkpoint.values, states, inputs)


def load_saved_model(path: str | PathLike[str], model: GreyBoxModel | str | None = None) -> SavedModel:
    """The model of the checkpoint at ``path``, with its effects.

    Args:
        model: the plain model, or how to load it ("my_motor.py:Motor"). Not needed where it is a built-in system. A model file that only
            the checkpoint names is never run: a checkpoint may come from anywhere.

    Raises:
        UserError: the checkpoint is damaged, is of a model file and ``model`` is not given, or is not one of ``model``.
    """
    path = Path(path)
    checkpoint = load_checkpoint(path)
    base = _plain_model(path, checkpoint, model)
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
    data, base, model_name = _own_model(data, Path(path), load_checkpoint(path), model, model_name)
    saved = load_saved_model(path, base)
    problem = make_problem(data, saved.model, data.recordings)
    problem = problem.with_values(np.array([saved.checkpoint.values[name] for name in problem.names]))
    _check_admissible(Path(path), problem)
    if saved.checkpoint.free_starts:
        problem = all_starts_free(data, problem)
    return Restored(data, model_name, problem)


def _plain_model(path: Path, checkpoint: Checkpoint, model: GreyBoxModel | str | None) -> GreyBoxModel:
    """The model without effects: the user's, or a built-in system. Code that a checkpoint names is not run on its word."""
    if model is None and checkpoint.model not in BUILT_IN:
        raise UserError(
            f"checkpoint {path}: is of the model {checkpoint.title} in {checkpoint.model}; a model file is run only where you name it "
            "yourself: give the model as the argument model"
        )
    return (
        load_model(checkpoint.model if model is None else model) if model is None or isinstance(model, str) else model
    )


def _own_model(
    data: DataSet, path: Path, checkpoint: Checkpoint, model: GreyBoxModel, model_name: str
) -> tuple[DataSet, GreyBoxModel, str]:
    """The model of a checkpoint is the one at hand, wherever its file lies now, or a built-in system."""
    if checkpoint.model == model_name:
        return data, model, model_name
    same = checkpoint.title == model.title
    if checkpoint.model in BUILT_IN:
        data = data if same else replace(data, parameters={}, initial={})  # the card speaks of another model
        return data, load_model(checkpoint.model), checkpoint.model
    if not same:
        raise UserError(
            f"checkpoint {path}: is of the model {checkpoint.title} in {checkpoint.model}, not of {model.title}; a model file is run only "
            "where you name it yourself: on the card, as --model, or as the argument model"
        )
    return data, model, model_name


def _with_effects(path: Path, base: GreyBoxModel, effects: Sequence[Mapping[str, Any]]) -> GreyBoxModel:
    try:
        return restored_model(base, effects)
    except UserError as error:
        raise UserError(f"checkpoint {path}: {error}") from None
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise UserError(f'checkpoint {path}: "effects" are damaged: {type(error).__name__}: {error}') from None


def _check_admissible(path: Path, problem: Problem) -> None:
    """Values within the card's bounds, or within the model's own where the card narrows them, and within the model's constraints."""
    title = problem.model.title
    for k, parameter in enumerate(problem.model.declared_parameters):
        lower = min(problem.lower[k], parameter.bounds[0])
        upper = max(problem.upper[k], parameter.bounds[1])
        if not lower <= problem.values[k] <= upper:
            raise UserError(
                f"checkpoint {path}: {parameter.name} is {problem.values[k]:g}, outside its bounds [{lower:g}, {upper:g}] in model {title}"
            )
    if not problem.admissible(problem.values):
        raise UserError(
            f"checkpoint {path}: its values break a constraint of model {title}; expected values that it allows"
        )
