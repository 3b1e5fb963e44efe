"""Arguments of the public functions, checked before anything is computed."""

from __future__ import annotations

import math
from collections.abc import Iterable
from numbers import Integral, Real
from pathlib import Path
from typing import Any, TypeVar

import torch

from greybox_torch.checking.constant_channels import resting_at, rests
from greybox_torch.data import DataSet
from greybox_torch.errors import ArgumentError, Kind, UserError, did_you_mean, quoted
from greybox_torch.estimate.precision import PRECISIONS
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.check import check_equations
from greybox_torch.model.once_per_model import once_per_model
from greybox_torch.model.own_weights import with_weights_held
from greybox_torch.systems import BUILT_IN, load_model

Settings = TypeVar("Settings")
Told = TypeVar("Told")


def check_model(model: Any, *, runs: bool = True) -> GreyBoxModel:
    """The model that was given itself, or as the result of a fit or a diagnosis; of one with weights of its own a copy that holds them.

    ``runs`` says whether its equations are to be computed, and not its declarations alone read.

    Raises:
        ArgumentError: neither of them.
        UserError: its equations cannot be computed.
    """
    held = model if isinstance(model, GreyBoxModel) else getattr(model, "model", None)
    if isinstance(held, GreyBoxModel):
        if runs and not isinstance(held, AugmentedModel):
            _sound_equations(held)
        return with_weights_held(held)
    if isinstance(model, type) and issubclass(model, GreyBoxModel):
        name = model.__name__
        raise ArgumentError("model", Kind(f"the class {name}"), f"expected an object of it: {name}()")
    named = f", as load_model({quoted(model)}) gives one" if isinstance(model, str) else ""
    raise ArgumentError("model", Kind.of(model), f"expected a model{named}, or the result of fit or diagnose")


@once_per_model
def _sound_equations(model: GreyBoxModel) -> None:
    """Raises UserError where the equations cannot be computed, once for each model."""
    try:
        check_equations(model)
    except UserError as error:
        raise UserError(f"model {model.title}: {error}") from None


def named_model(card: Path, data: DataSet, name: str | None = None) -> GreyBoxModel:
    """The model called ``name``, or else as the data set's card says.

    Raises:
        UserError: neither names one, or it cannot be loaded; the message begins with ``card``, the card's place.
    """
    wanted = name or data.model
    if wanted is None:
        known = ", ".join(BUILT_IN)
        raise UserError(
            f"{card}: [model] name is missing and no --model is given; expected a built-in system ({known}) or a file and class "
            "such as my_motor.py:Motor"
        )
    return load_model(wanted)


def check_estimation(data: DataSet) -> None:
    """Raises UserError where no experiment of the data set is there to estimate from."""
    if not data.estimation():
        raise UserError(
            f'{data.place("[[experiment]] role:")} no experiment has the role "estimation"; expected at least one'
        )


def check_moving(data: DataSet, model: GreyBoxModel) -> None:
    """Raises UserError where no output of the model moves in any experiment that is estimated from: every law would do."""
    runs, outputs = data.estimation(), [output.name for output in model.outputs]
    if outputs and all(rests(run, name) for run in runs for name in outputs):
        stuck = ", ".join(f"{name}: {resting_at(runs, name, None)}" for name in outputs)
        raise UserError(
            f"{data.place('[[experiment]]')} no output moves in the experiments of role 'estimation' ({stuck}, constant throughout): "
            "nothing can be estimated or found from them; expected recordings in which the machine moves, or other columns, where a "
            "sensor is stuck"
        )


def check_experiment(data: DataSet, experiment: Any) -> str:
    """Raises ArgumentError where ``data`` has no experiment of that name."""
    names = [recording.name for recording in data.recordings]
    if experiment not in names:
        hint = did_you_mean(str(experiment), names)
        raise ArgumentError("experiment", experiment, f"expected one of {', '.join(names)}{hint}")
    return experiment


def check_device(device: str) -> str:
    """The device as torch names it. Raises ArgumentError where torch does not know it or this machine does not have it."""
    try:
        known = torch.device(device)
    except (RuntimeError, TypeError):
        known = None
    if known is None or known.type not in ("cpu", "cuda"):
        raise ArgumentError("device", device, 'expected "cpu", "cuda" or "cuda:N"')
    if known.type == "cpu":
        return "cpu"
    count = torch.cuda.device_count() if torch.cuda.is_available() else 0
    if (known.index or 0) >= count:
        have = f"{count} CUDA device{'s' * (count != 1)}" if count else "no CUDA device that torch can use"
        raise ArgumentError("device", device, f"this machine has {have}")
    return str(known)


def check_precision(precision: str) -> str:
    """Raises ArgumentError where ``precision`` is not one."""
    if precision not in PRECISIONS:
        expected = " or ".join(f'"{known}"' for known in PRECISIONS)
        raise ArgumentError("precision", precision, f"expected {expected}{did_you_mean(str(precision), PRECISIONS)}")
    return precision


def check_whole(argument: str, value: Any, low: int, high: int) -> int:
    """``value``, which may be one of NumPy's. Raises ArgumentError where it is not a whole number from ``low`` to ``high``."""
    if isinstance(value, bool) or not isinstance(value, Integral) or not low <= int(value) <= high:
        raise ArgumentError(argument, value, f"expected a whole number from {low} to {high}")
    return int(value)


def check_seconds(argument: str, value: Any) -> float:
    """``value``, which may be one of NumPy's. Raises ArgumentError where it is not a finite number above zero."""
    if isinstance(value, bool) or not isinstance(value, Real) or not 0 < float(value) < math.inf:
        raise ArgumentError(argument, value, "expected a number above 0")
    return float(value)


def check_seed(seed: Any) -> int:
    """Raises ArgumentError where ``seed`` cannot be one."""
    return check_whole("seed", seed, 0, 2**32 - 1)


def check_names(argument: str, names: Iterable[str]) -> tuple[str, ...]:
    """The names, each once. Raises ArgumentError for a text, which would be taken letter by letter."""
    if isinstance(names, str):
        raise ArgumentError(argument, names, f'expected a list of names, such as ["{names}"]')
    return tuple(dict.fromkeys(names))


def check_told(argument: str, value: Told, what: str = "a text") -> Told:
    """A function that is told of progress. Raises ArgumentError where ``value`` is none; ``what`` it is called with."""
    if not callable(value):
        raise ArgumentError(argument, value, f"expected a function that is called with {what}; leave it out for none")
    return value


def check_kind(argument: str, value: Settings, kind: type[Settings]) -> Settings:
    """Raises ArgumentError where ``value`` is not of the class ``kind``."""
    if not isinstance(value, kind):
        raise ArgumentError(argument, Kind.of(value), f"expected {kind.__name__}(…)")
    return value
