"""A copy of a model that holds other values: what results carry, so that the model they were made from stays as it is."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from copy import deepcopy
from dataclasses import replace
from typing import Any

from greybox_torch.model.declarations import Parameter
from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.model.own_weights import let_go


def copy_holding(
    model: GreyBoxModel,
    values: Mapping[str, float],
    *,
    declared: Iterable[Parameter] = (),
    starts_free: bool = False,
) -> GreyBoxModel:
    """A deep copy of ``model`` whose parameters have ``values``, as if set by :meth:`GreyBoxModel.set_values`.

    Args:
        values: by parameter, in its unit. They become the declared values of the copy; bounds that do not hold them are widened.
        declared: parameters that are declared otherwise than by the model, as a data card does: their bounds, and what is fixed.
        starts_free: whether the copy's start states are all estimated, see :attr:`GreyBoxModel.starts_free`.
    """
    made = deepcopy(model)
    let_go(made)
    replaced = {p.name: p for p in declared}
    part: Any = made
    while part is not None:
        _redeclare(part, values, replaced)
        part = None if part.plain is part else part.base
    made.starts_free = starts_free or model.starts_free
    return made


def _redeclare(model: GreyBoxModel, values: Mapping[str, float], replaced: Mapping[str, Parameter]) -> None:
    held = {p.name: float(values[p.name]) for p in model.declared_parameters if p.name in values}
    model.declared_parameters = tuple(
        _with_value(replaced.get(p.name, p), held[p.name]) if p.name in held else p for p in model.declared_parameters
    )
    model.set_values(held)


def _with_value(parameter: Parameter, value: float) -> Parameter:
    low, high = parameter.bounds
    return replace(parameter, value=value, lower=min(low, value), upper=max(high, value))
