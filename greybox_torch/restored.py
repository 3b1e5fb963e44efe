"""The way back from a checkpoint's two files to a model that simulates, effects included. Needs nothing of the diagnosis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import torch

from greybox_torch.checkpoint import (
    Checkpoint,
    check_same_parameters,
    check_same_units,
    check_same_weights,
    load_checkpoint,
)
from greybox_torch.data import DataSet
from greybox_torch.errors import UserError
from greybox_torch.estimate.problem import with_card
from greybox_torch.mechanisms.attached import attached
from greybox_torch.mechanisms.network import own_name
from greybox_torch.mechanisms.stored import restored_model
from greybox_torch.model import GreyBoxModel, Parameter
from greybox_torch.model.copies import copy_holding
from greybox_torch.model.own_weights import digest
from greybox_torch.rates import rates_at
from greybox_torch.systems import BUILT_IN, defined_here, load_model


@dataclass(frozen=True)
class SavedModel:
    """A checkpoint's ``model``, effects included, holding its values, without any recordings; ``base`` is the same without the effects."""

    checkpoint: Checkpoint
    base: GreyBoxModel
    model: GreyBoxModel

    def rates(self, states: Mapping[str, Any], inputs: Mapping[str, Any] | None = None) -> dict[str, np.ndarray]:
        """The rates of all states at given states and inputs, see :func:`greybox_torch.rates.rates_at`."""
        return rates_at(self.model, self.checkpoint.values, states, inputs)


def load(path: str | PathLike[str], model: GreyBoxModel | str | None = None) -> GreyBoxModel:
    """The model that a fit, a training or a diagnosis has saved: with its effects, holding its values, to be used like any other.

    Args:
        path: either of the checkpoint's two files, what their names have in common, or the folder of results that it is in.
        model: the plain model, or how to load it ("my_motor.py:Motor"). Not needed where it is a built-in system, or of a class that this
            session has already defined. A model file that only the checkpoint names is never run: a checkpoint may come from anywhere.

    Raises:
        UserError: the checkpoint is damaged, is of a model that is not at hand, or is not one of ``model``.

    Examples:
        ``greybox_torch.simulate(greybox_torch.load("results", model="my_motor.py:Motor"), data)``
    """
    return load_saved_model(path, model).model


def load_saved_model(path: str | PathLike[str], model: GreyBoxModel | str | None = None) -> SavedModel:
    """What :func:`load` loads, with the checkpoint's card and the model without effects.

    Args:
        path: of the checkpoint, as for :func:`load`.
        model: the plain model, or how to load it, where it is not at hand otherwise, as for :func:`load`.

    Raises:
        UserError: the checkpoint is damaged, is of a model that is not at hand, or is not one of ``model``.
    """
    path = Path(path)
    checkpoint = load_checkpoint(path)
    return _saved(path, checkpoint, _with_effects(path, _plain_model(path, checkpoint, model), checkpoint))


def load_beside(path: str | PathLike[str], own: GreyBoxModel, data: DataSet) -> tuple[GreyBoxModel, DataSet]:
    """The checkpoint at ``path`` for simulating ``data``, whose card is meant for the model ``own``.

    A built-in system is loaded; any other model of a checkpoint is taken to be ``own``, wherever its file lies now.

    Returns:
        The model, and the data set without what its card says of another model.

    Raises:
        UserError: the checkpoint is damaged, is not one of ``own``, or holds values outside the bounds of card and model.
    """
    path = Path(path)
    checkpoint = load_checkpoint(path)
    if checkpoint.model not in BUILT_IN and checkpoint.title != own.title:
        raise UserError(
            f"checkpoint {path}: is of the model {checkpoint.title} in {checkpoint.model}, not of {own.title}; expected a checkpoint of "
            f"{own.title}, or {checkpoint.title} as the model that is named: on the card, as --model, or as the argument model"
        )
    plain = own.plain if checkpoint.title == own.title else load_model(checkpoint.model)
    data = card_of(data, own, plain)
    model = _with_effects(path, plain, checkpoint)
    _check_bounds(path, checkpoint, model, with_card(data, model))
    return _saved(path, checkpoint, model).model, data


def card_of(data: DataSet, own: GreyBoxModel, model: GreyBoxModel) -> DataSet:
    """``data`` for simulating ``model``: without what its card says of parameters and start states if that is of ``own``, another model."""
    return data if model.title == own.title else replace(data, parameters={}, initial={})


def _plain_model(path: Path, checkpoint: Checkpoint, model: GreyBoxModel | str | None) -> GreyBoxModel:
    """The model without effects: the user's, or a built-in system. Code that a checkpoint names is not run on its word."""
    if isinstance(model, GreyBoxModel):
        return model.plain
    if model is not None or checkpoint.model in BUILT_IN:
        return load_model(model or checkpoint.model)
    defined = defined_here(checkpoint.model)
    if defined is None:
        file = checkpoint.model if ":" in checkpoint.model else f"my_model.py:{checkpoint.title}"
        raise UserError(
            f"checkpoint {path}: is of the model {checkpoint.title} in {checkpoint.model}; a model file is run only where you name it "
            f"yourself, with --model, or --dataset of a command that has it (in Python: load({str(path)!r}, model={file!r}))"
        )
    return defined()


def _saved(path: Path, checkpoint: Checkpoint, model: GreyBoxModel) -> SavedModel:
    checkpoint = _with_later_parameters(_with_present_names(checkpoint, model), model)
    check_same_parameters(path, checkpoint, model.title, [p.name for p in model.declared_parameters])
    check_same_units(path, checkpoint, model.title, {p.name: p.unit for p in model.plain.declared_parameters})
    check_same_weights(path, checkpoint, model.title, digest(model))
    held = copy_holding(model, checkpoint.values, starts_free=checkpoint.free_starts)
    _check_admissible(path, held)
    return SavedModel(checkpoint, held.plain, held)


def _with_present_names(checkpoint: Checkpoint, model: GreyBoxModel) -> Checkpoint:
    """The checkpoint with the names that parameters have now: a network's of a signal from elsewhere had the sign in that signal's name."""
    present = {p.name for p in model.declared_parameters}
    named = {name: own_name(name) for name in checkpoint.values if name not in present and own_name(name) in present}
    if not named:
        return checkpoint
    values = {named.get(name, name): value for name, value in checkpoint.values.items()}
    return replace(checkpoint, values=values, units={named.get(n, n): unit for n, unit in checkpoint.units.items()})


def _with_later_parameters(checkpoint: Checkpoint, model: GreyBoxModel) -> Checkpoint:
    """The checkpoint with zero for what its laws did not have when it was written."""
    later = {f"{a.prefix}.{name}" for a in attached(model)[1] for name in a.mechanism.later}
    names = [p.name for p in model.declared_parameters]
    if not later & (set(names) - set(checkpoint.values)):
        return checkpoint
    held = {n: checkpoint.values.get(n, 0.0) for n in names if n in checkpoint.values or n in later}
    return replace(checkpoint, values={**held, **checkpoint.values})


def _check_bounds(path: Path, checkpoint: Checkpoint, model: GreyBoxModel, carded: Sequence[Parameter]) -> None:
    """Values within the card's bounds, or within the model's own where the card narrows them."""
    for on_card, declared in zip(carded, model.declared_parameters, strict=True):
        lower = min(on_card.bounds[0], declared.bounds[0])
        upper = max(on_card.bounds[1], declared.bounds[1])
        value = checkpoint.values.get(declared.name, lower)
        if not lower <= value <= upper:
            raise UserError(
                f"checkpoint {path}: {declared.name} is {value:g}, outside its bounds [{lower:g}, {upper:g}] in model {model.title}"
            )


def _with_effects(path: Path, base: GreyBoxModel, checkpoint: Checkpoint) -> GreyBoxModel:
    if not checkpoint.effects:
        return base
    try:
        return restored_model(base, checkpoint.effects)
    except UserError as error:
        raise UserError(f"checkpoint {path}: {error}") from None
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
        raise UserError(f'checkpoint {path}: "effects" are damaged: {type(error).__name__}: {error}') from None


def _check_admissible(path: Path, model: GreyBoxModel) -> None:
    with torch.no_grad():
        broken = [name for name, value in model.admissible(model.physical()).items() if not float(value) > 0]
    if broken:
        raise UserError(
            f"checkpoint {path}: its values break a constraint of model {model.title} ({', '.join(broken)} must be positive); "
            "expected values that it allows"
        )
