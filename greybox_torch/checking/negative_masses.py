"""Masses and inertias that begin below zero: pushed, such a body goes the other way, and ever faster."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import torch

from greybox_torch.checking.dimensions import dimension_of, known_dimension
from greybox_torch.checking.finding import Finding
from greybox_torch.checking.points import Points
from greybox_torch.checking.source import Source
from greybox_torch.in_unit import in_unit
from greybox_torch.model import GreyBoxModel

_KINDS = {"mass": dimension_of("kg"), "inertia": dimension_of("kg m^2")}


def negative_masses(
    model: GreyBoxModel, source: Source, values: Mapping[str, float] | None = None
) -> Iterator[Finding]:
    """Warnings for parameters in kg or kg m^2 with a negative start value.

    Args:
        values: of parameters, where a card has others than the model.
    """
    known = {**model.values(), **(values or {})}
    for p in model.declared_parameters:
        kind = _kind(p.unit)
        if kind and known[p.name] < 0:
            yield Finding(
                "warning",
                "numbers",
                f"{p.name} begins at {in_unit(f'{known[p.name]:g}', p.unit)}: with a negative {kind} a model runs away",
                f'a value above zero, and a bound: Parameter("{p.name}", …, lower=0.0)',
                source.file,
                source.line_of(f'"{p.name}"'),
            )


def with_masses_above_zero(model: GreyBoxModel, points: Points) -> Points:
    """The points with the masses and inertias that are negative there of the other sign, so that what is pushed goes the way it should."""
    massive = torch.tensor([bool(_kind(p.unit)) for p in model.declared_parameters], dtype=torch.bool).reshape(-1, 1)
    return replace(points, p=torch.where(massive, points.p.detach().abs(), points.p.detach()).requires_grad_())


def _kind(unit: str) -> str:
    found = known_dimension(unit)
    return next((kind for kind, dimension in _KINDS.items() if found == dimension), "")
