"""Values at which the equations are tried: states and inputs from small to large, and parameters around their declared values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import torch

from greybox_torch.model import GreyBoxModel, Signals

SIZES = (1e-5, 0.01, 1.0, 30.0)
"""Standard deviations of states and inputs; the least for machines whose gaps are fractions of a millimetre, beyond which a clamp hides."""

EACH = 32
"""Points of each size."""

DECADES, WIDE = (-3.0, 6.0), 512
"""Powers of ten that the wider points are drawn between, and how many of each order there are."""

SPREAD = 0.3
"""Standard deviation of the logarithm of a parameter around its declared value."""


@dataclass(frozen=True)
class Points:
    """B points: states (n_x, B), inputs (n_u, B), parameters (n_p, B) and forces at the declared ports (n_f, B), all leaves of autograd."""

    x: torch.Tensor
    u: torch.Tensor
    p: torch.Tensor
    f: torch.Tensor

    def signals(self, model: GreyBoxModel) -> tuple[Signals, Signals, Signals, Signals]:
        """The points by name, as the equations are handed them."""
        return (
            *model.named_signals(self.x, self.u),
            Signals("parameter", {q.name: self.p[i] for i, q in enumerate(model.declared_parameters)}),
            Signals("port", ports_of(model, self.f)),
        )


def ports_of(model: GreyBoxModel, forces: torch.Tensor) -> dict[str, torch.Tensor]:
    """By port: the declared ones as rows of ``forces``; actuators and sensors, which act elsewhere, zero."""
    given = {port.name: forces[i] for i, port in enumerate(model.ports)}
    rest = {port.name: torch.zeros((), dtype=torch.float64) for port in model.all_ports if port.name not in given}
    return {**given, **rest}


def points_of(model: GreyBoxModel) -> Points:
    """The same points at every call."""
    draw = np.random.default_rng(0)
    sizes = np.repeat(SIZES, EACH)
    x, u, f = (draw.normal(size=(len(of), len(sizes))) * sizes for of in (model.states, model.inputs, model.ports))
    return Points(*_leaves(x, u, _parameters(model, draw, len(sizes)), f))


def wide_points(model: GreyBoxModel) -> Points:
    """Points for equations that give no number at any of :func:`points_of`: values above zero over many decades, as absolute temperatures
    and pressures have, in the order drawn, rising and falling from state to state, as levels and pressures along a line may have to; and
    states that are all between 0 and 1, as fractions are.
    """
    draw = np.random.default_rng(0)
    drawn = 10.0 ** draw.uniform(*DECADES, size=(len(model.states), WIDE)) * draw.uniform(0.5, 2.0, size=WIDE)
    fractions = draw.uniform(size=(len(model.states), WIDE))
    x = np.hstack([drawn, np.sort(drawn, axis=0), np.sort(drawn, axis=0)[::-1], fractions])
    count = x.shape[1]
    u = 10.0 ** draw.uniform(*DECADES, size=(len(model.inputs), count))
    f = draw.normal(size=(len(model.ports), count))
    return Points(*_leaves(x, u, _parameters(model, draw, count), f))


def start_of(
    model: GreyBoxModel, values: Mapping[str, float], begun: tuple[np.ndarray, np.ndarray] | None = None
) -> Points:
    """One point: states where they are declared to start, inputs, forces and measured starts zero, and parameters as declared.

    Args:
        values: of parameters that have others; those without any value are one.
        begun: states (n_x,) and inputs (n_u,) where a recording begins.
    """
    x, u = begun or (
        [0.0 if s.initial == "measured" else float(s.initial) for s in model.states],
        [0.0] * len(model.inputs),
    )
    p = [values.get(q.name, q.value) for q in model.declared_parameters]
    rows = (x, u, [v if v == v else 1.0 for v in p], [0.0] * len(model.ports))
    return Points(*(torch.as_tensor(row, dtype=torch.float64).reshape(-1, 1) for row in rows))


def _parameters(model: GreyBoxModel, draw: np.random.Generator, count: int) -> np.ndarray:
    """``count`` values of each declared parameter around its own, (n_p, count)."""
    rows = [
        _around(q.value, *q.bounds, draw.normal(size=count), draw.uniform(size=count))
        for q in model.declared_parameters
    ]
    return np.array(rows) if rows else np.zeros((0, count))


def _leaves(*values: np.ndarray) -> list[torch.Tensor]:
    return [torch.tensor(a, dtype=torch.float64, requires_grad=True) for a in values]


def _around(value: float, low: float, high: float, normal: np.ndarray, uniform: np.ndarray) -> np.ndarray:
    """Values around ``value`` within the bounds; a parameter at zero takes all of them, as others may act through it alone."""
    if value != 0.0:
        drawn = value * np.exp(SPREAD * normal)
    else:
        drawn = max(low, -1.0) + uniform * (min(high, max(low, 0.0) + 1.0) - max(low, -1.0))
    return np.clip(drawn, low, high)
