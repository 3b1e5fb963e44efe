"""A copy of a model that holds other values: what results carry, so that the model they were made from stays as it is."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import replace

from greybox_torch.model.declarations import Parameter
from greybox_torch.model.greybox_model import GreyBoxModel


def copy_holding(
    model: GreyBoxModel,
    values: Mapping[str, float],
    *,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    fixed: Mapping[str, bool] | None = None,
    starts_free: bool = False,
) -> GreyBoxModel:
    """A deep copy of ``model`` whose parameters have ``values``, as if set by :meth:`GreyBoxModel.set_values`.

    Args:
        values: by parameter, in its unit. They become the declared values of the copy; bounds that do not hold them are widened.
        bounds: by parameter (lower, upper), those that a data card has given.
        fixed: by parameter, whether it is known rather than to be estimated.
        starts_free: whether the copy's start states are all estimated, see :attr:`GreyBoxModel.starts_free`.
    """
    made = deepcopy(model)
    part: GreyBoxModel | None = made
    while part is not None:
        _redeclare(part, values, bounds or {}, fixed or {})
        part = part.base if part.plain is not part else None  # type: ignore[assignment]
    made.starts_free = starts_free or model.starts_free
    return made


def _redeclare(
    model: GreyBoxModel,
    values: Mapping[str, float],
    bounds: Mapping[str, tuple[float, float]],
    fixed: Mapping[str, bool],
) -> None:
    own = [p for p in model.declared_parameters if p.name in values]
    held = {p.name: float(values[p.name]) for p in own}
    changed = {p.name: _changed(p, held[p.name], bounds.get(p.name, p.bounds), fixed.get(p.name, p.fixed)) for p in own}
    model.declared_parameters = tuple(changed.get(p.name, p) for p in model.declared_parameters)
    model.set_values(held)
    for name, parameter in changed.items():
        model.raw[name.replace(".", "/")].requires_grad_(not parameter.fixed)


def _changed(parameter: Parameter, value: float, bounds: tuple[float, float], fixed: bool) -> Parameter:
    low, high = min(bounds[0], value), max(bounds[1], value)
    return replace(parameter, value=value, lower=low, upper=high, fixed=fixed)
