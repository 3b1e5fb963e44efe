"""Data, models and their names among the arguments of the public functions, checked before anything is computed."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import Any

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
    check_no_data(model)
    named = f", as load_model({quoted(model)}) gives one" if isinstance(model, str) else ""
    raise ArgumentError("model", Kind.of(model), f"expected a model{named}, or the result of fit or diagnose")


def check_no_data(model: Any) -> None:
    """Raises ArgumentError where data, or their card by path, stand in the place of a model."""
    by_path = isinstance(model, str | PathLike) and Path(model).suffix == ".toml"
    if by_path or isinstance(model, DataSet):
        found = str(model) if by_path else Kind.of(model)
        raise ArgumentError("model", found, "expected a model first, and the data second, as in fit(model, data)")


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


def check_precision(precision: str) -> str:
    """Raises ArgumentError where ``precision`` is not one."""
    if precision not in PRECISIONS:
        expected = " or ".join(f'"{known}"' for known in PRECISIONS)
        raise ArgumentError("precision", precision, f"expected {expected}{did_you_mean(str(precision), PRECISIONS)}")
    return precision
