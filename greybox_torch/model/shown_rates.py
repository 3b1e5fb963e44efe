"""Outputs that are accelerations: a sensor that shows how fast a speed changes shows what pushes there, also what the model lacks.

An output may be written as its equation, ``-(F + R) / m``, without the forces at the ports. Where it is the rate of a state, a sum of rates
with constant factors (the middle of a beam), or differs from that by what no parameter changes (a car's lateral acceleration v' + U r),
the forces at the ports reach it as they reach the rates.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import torch

from greybox_torch.model.once_per_model import once_per_model
from greybox_torch.model.port_forces import no_forces, with_one
from greybox_torch.model.random_points import POINTS, random_points
from greybox_torch.model.signals import Signals
from greybox_torch.model.unit_of_rate import unit_of_rate

if TYPE_CHECKING:
    from greybox_torch.model.greybox_model import GreyBoxModel

EXACT = 1e-9
"""Share of an output's spread up to which a sum of rates is the output."""

DRAWS = 6
"""Sets of parameters at every point."""

SPREAD = 0.3
"""By what share parameters are varied: a force is a mass times an acceleration, and a mass is no constant factor."""


def with_shown_rates(
    model: GreyBoxModel, outputs: Mapping[str, Any], x: Any, u: Any, p: Any, port: Any
) -> dict[str, Any]:
    """``outputs`` at states x, inputs u and parameters p, with what the forces ``port`` change of the rates that they show."""
    shown = shown_rates(model)
    if not shown:
        return dict(outputs)
    acting, without = model.derivative(x, u, p, port), model.derivative(x, u, p, no_forces(model))
    changes = {name: sum(c * (acting[s] - without[s]) for s, c in rates.items()) for name, rates in shown.items()}
    return {name: value + changes[name] if name in changes else value for name, value in outputs.items()}


@once_per_model
def shown_rates(model: GreyBoxModel) -> Mapping[str, Mapping[str, float]]:
    """By output, the states whose rates it shows, with constant factors; without outputs that show none, or have another unit."""
    if model.asks_for_forces or not model.ports:
        return {}
    x, u, p = _points(model)
    none = no_forces(model)
    rates = model.derivative(x, u, p, none)
    pushed = [model.derivative(x, u, p, with_one(none, port.name)) for port in model.ports]
    reached = [s.name for s in model.states if any(_differ(one[s.name], rates[s.name]) for one in pushed)]
    if not reached:
        return {}
    outputs = model.output(x, u, p)
    columns = np.stack([_by_parameters(rates[name]) for name in reached], axis=1)
    units = {s.name: s.unit for s in model.states}
    found: dict[str, dict[str, float]] = {}
    for output in model.outputs:
        factors = _factors(columns, _by_parameters(outputs[output.name]))
        own = {name: float(c) for name, c in zip(reached, factors, strict=True) if c}
        if own and all(_fits(output.unit, units[name], c, len(own)) for name, c in own.items()):
            found[output.name] = own
    return found


def _points(model: GreyBoxModel) -> tuple[Signals, Signals, Signals]:
    """Random states and inputs (POINTS times DRAWS,), every point with several sets of parameters around their declared values."""
    x, u, declared = random_points(model)
    states, inputs = model.named_signals(x.repeat(1, DRAWS), u.repeat(1, DRAWS))
    draw = torch.Generator().manual_seed(1)

    def varied(value: torch.Tensor) -> torch.Tensor:
        return value * (1.0 + SPREAD * (2.0 * torch.rand(DRAWS * POINTS, generator=draw, dtype=torch.float64) - 1.0))

    return states, inputs, Signals("parameter", {name: varied(value) for name, value in declared.items()})


def _by_parameters(value: Any) -> np.ndarray:
    """What the parameters change at every point: values less their mean over the sets of parameters."""
    there = _row(value).reshape(DRAWS, POINTS)
    with np.errstate(invalid="ignore"):  # a root of a negative number at a random point
        return (there - there.mean(axis=0)).ravel()


def _factors(columns: np.ndarray, output: np.ndarray) -> np.ndarray:
    """The constant factors (k,) with which rates (N, k) make up an output (N,); zeros where no such sum does."""
    nothing = np.zeros(columns.shape[1])
    if not (np.isfinite(columns).all() and np.isfinite(output).all()) or not output.any():
        return nothing
    scale = np.maximum(np.abs(columns).max(axis=0), np.finfo(float).tiny)
    factors, _, rank, _ = np.linalg.lstsq(columns / scale, output, rcond=EXACT)
    missed = np.abs(columns / scale @ factors - output).max()
    if rank < columns.shape[1] or missed > EXACT * np.abs(output).max():
        return nothing
    return np.where(np.abs(factors) > 1e3 * EXACT * np.abs(factors).max(), np.round(factors / scale, 12), 0.0)


def _fits(output: str, state: str, factor: float, count: int) -> bool:
    """Whether an output's unit is that of a state's rate; without units, whether it is that rate itself: else it may be a force."""
    if output and state:
        return output.replace(" ", "") == unit_of_rate(state).replace(" ", "")
    return count == 1 and abs(abs(factor) - 1.0) < EXACT


def _row(value: Any) -> np.ndarray:
    return torch.as_tensor(value, dtype=torch.float64).expand(DRAWS * POINTS).numpy()


def _differ(one: Any, other: Any) -> bool:
    return not np.array_equal(_row(one), _row(other))
