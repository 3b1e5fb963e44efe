"""What is exported of a model: its equations as an expression graph, its variables, and a switch for every effect."""

from __future__ import annotations

import keyword
import re
from dataclasses import dataclass

from greybox_torch.codegen.arrays import UnsupportedOperation
from greybox_torch.codegen.lower import Equations, lower
from greybox_torch.errors import ArgumentError, UserError
from greybox_torch.exporting.delays import Delay, delays_of, with_delays
from greybox_torch.mechanisms.attached import attached
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.mechanism import SHARE
from greybox_torch.mechanisms.pitch import with_pitch
from greybox_torch.model import GreyBoxModel, Parameter

USUAL_STEP = 1e-3
"""Seconds of an integration step where nothing says how many are needed."""


@dataclass(frozen=True)
class Variable:
    """A state (``value`` its start), an input or output (``value`` 0), or a parameter, in ``unit``."""

    name: str
    unit: str
    value: float
    description: str = ""
    lower: float = float("-inf")
    upper: float = float("inf")
    is_switch: bool = False


@dataclass(frozen=True)
class ExportedModel:
    """A model as it is exported.

    ``identifier`` names functions and files, ``step`` is the largest integration step in seconds, ``hold`` how inputs run between samples
    ("zoh" or "foh"); a parameter that ``is_switch`` is 1 where
    its effect acts and 0 where it does not. Variables stand in the order of the leaves of ``equations``; after the inputs follow those that
    ``delays`` say.
    """

    identifier: str
    title: str
    description: str
    equations: Equations
    states: tuple[Variable, ...]
    inputs: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    parameters: tuple[Variable, ...]
    step: float
    hold: str = "zoh"
    delays: tuple[Delay, ...] = ()


def exported(
    model: GreyBoxModel, identifier: str | None = None, step: float | None = None, hold: str = "zoh"
) -> ExportedModel:
    """The model with the values that it holds.

    Args:
        identifier: letters, digits and underscores; by default made from the model's title.
        step: largest integration step in seconds; by default that of the recordings that effects were found in.

    Raises:
        ArgumentError: no identifier in C and Python, or a step that is none.
        UserError: equations without a compiled form, or a dead time without a longest value.
    """
    name = identifier_of(model, identifier)
    if step is not None and not 0.0 < step < float("inf"):
        raise ArgumentError("step", step, "expected seconds, above 0")
    values = model.values()
    whole, switches = _switchable(model)
    delays = delays_of(whole)
    try:
        equations = with_delays(lower(whole, ()), len(whole.plain.inputs), len(delays))
    except UnsupportedOperation as error:
        raise UserError(
            f"model {model.title}: {error} has no form outside of torch; greybox check says what to write"
        ) from None
    return ExportedModel(
        name,
        model.title,
        " ".join((type(model.plain).__doc__ or "").split("\n\n")[0].split()),
        equations,
        tuple(
            Variable(s.name, s.unit, 0.0 if s.initial == "measured" else float(s.initial), s.description)
            for s in whole.states
        ),
        tuple(Variable(i.name, i.unit, 0.0, i.description) for i in whole.plain.inputs),
        tuple(Variable(o.name, o.unit, 0.0, o.description) for o in whole.outputs),
        tuple(_parameter(p, values.get(p.name, 1.0), is_switch=p.name in switches) for p in whole.declared_parameters),
        step if step is not None else step_without_data(whole)[0],
        hold,
        delays,
    )


def _parameter(declared: Parameter, value: float, is_switch: bool) -> Variable:
    told = with_pitch(declared.description, value, declared.unit)
    if is_switch:
        told = f"whether {declared.name.rpartition('.')[0]} acts: 1, or 0 where it does not"
    return Variable(declared.name, declared.unit, value, told, *declared.bounds, is_switch=is_switch)


def _switchable(model: GreyBoxModel) -> tuple[GreyBoxModel, set[str]]:
    """The model with a factor on each effect, and the names of these factors."""
    plain, attachments, surroundings = attached(model)
    if not attachments:
        return model, set()
    made = AugmentedModel(plain, attachments, surroundings, switched=attachments)
    return made, {f"{a.prefix}.{SHARE}" for a in attachments}


def step_without_data(model: GreyBoxModel) -> tuple[float, str]:
    """The integration step, in seconds, where no recordings say which one they need, and what it is, in words."""
    around = model.surroundings.values() if isinstance(model, AugmentedModel) else ()
    known = [s.sample_time for s in around if s.sample_time > 0.0]
    return (min(known), "the sample time that effects were found with") if known else (USUAL_STEP, "a usual one")


def identifier_of(model: GreyBoxModel, asked: str | None = None) -> str:
    """The name of functions and files: the one asked for, by default made from the model's title.

    Raises:
        ArgumentError: it is no identifier in C and Python.
    """
    if asked is None:
        made = re.sub(r"\W+", "_", model.title, flags=re.ASCII).strip("_") or "model"
        asked = made if made[0].isalpha() else f"model_{made}"
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]{0,60}", asked) or keyword.iskeyword(asked):
        raise ArgumentError("name", asked, "expected letters, digits and underscores, beginning with a letter")
    return asked
