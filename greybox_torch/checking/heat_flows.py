"""Temperatures of which one rises as another falls: heat flows from the warmer to the colder, so that a term has the wrong sign."""

from __future__ import annotations

from collections.abc import Iterator

import torch

from greybox_torch.checking.dimensions import dimension_of, known_dimension
from greybox_torch.checking.finding import Finding
from greybox_torch.checking.points import Points
from greybox_torch.checking.slopes import slopes
from greybox_torch.checking.source import Source
from greybox_torch.model import GreyBoxModel

_TEMPERATURE = dimension_of("K")


def heat_against_the_fall(model: GreyBoxModel, points: Points, source: Source) -> Iterator[Finding]:
    """A note for every pair of temperatures, a state and a state or input, of which the warmer one cools the other at all points.

    No error: a reaction may, and a controller in the equations.
    """
    x, u, p, f = points.signals(model)
    rates = model.derivative(x, u, p, f)
    warm = [("x", i, s.name, points.x) for i, s in enumerate(model.states) if _is_temperature(s.unit)]
    warm += [("u", i, s.name, points.u) for i, s in enumerate(model.inputs) if _is_temperature(s.unit)]
    for state in model.states:
        rate = torch.as_tensor(rates[state.name])
        if not _is_temperature(state.unit) or not rate.requires_grad:
            continue
        for kind, row, name, leaf in warm:
            if name == state.name:
                continue
            (slope,) = slopes(rate, (leaf,))
            if bool((slope[row] < 0.0).all()):
                yield Finding(
                    "note",
                    "influence",
                    f"a warmer {name} cools {state.name}, where heat flows from the warmer to the colder",
                    f"the term with {kind}.{name} in the rate of '{state.name}' turned, unless a controller or a reaction is meant",
                    source.file,
                    source.line_of(f'"{state.name}":'),
                )


def _is_temperature(unit: str) -> bool:
    return known_dimension(unit) == _TEMPERATURE
