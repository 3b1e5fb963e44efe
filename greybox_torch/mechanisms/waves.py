"""Sums of waves over a position: an order, and harmonics of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import torch

from greybox_torch.mechanisms.mechanism import Mechanism, Surroundings
from greybox_torch.mechanisms.pitch import order_told
from greybox_torch.model import Parameter, Signals

HARMONICS = 3
"""Of a wave whose order is known, the order itself included."""

OCTAVE = 2.0
"""How far an order may turn out to lie from the one that a screen found, where another effect had bent that: half of it is another wave,
of which it is the second harmonic. Seen: the friction of an arm's motor, of order 2, held at 2.03 by a narrower bound beside 2.53."""


def amplitudes(k: int) -> tuple[str, str]:
    """The names of the cosine's and the sine's amplitude of the k-th harmonic."""
    return ("a", "b") if k == 1 else (f"a_{k}", f"b_{k}")


def amplitudes_up_to(harmonics: int) -> tuple[str, ...]:
    """The names of all amplitudes."""
    return tuple(name for k in range(1, harmonics + 1) for name in amplitudes(k))


def strongest_wave(values: Mapping[str, float], harmonics: int) -> dict[str, float]:
    """A law's values with the largest wave of its sum alone, by the names of the first: its amplitudes and its order."""
    size = {k: math.hypot(*(values[n] for n in amplitudes(k))) for k in range(1, harmonics + 1)}
    largest = max(size, key=lambda k: size[k])
    beside = {n: v for n, v in values.items() if n not in amplitudes_up_to(harmonics)}
    alone = zip(amplitudes(1), (values[n] for n in amplitudes(largest)), strict=True)
    return beside | dict(alone) | {"order": largest * values["order"]}


def strongest_alone(
    law: Callable[[float], Mechanism], values: Mapping[str, float], harmonics: int
) -> tuple[Mechanism, Mapping[str, float]] | None:
    """The ``law`` of an order with the largest wave of a sum alone, and its values; None where the sum has no other."""
    if harmonics == 1:
        return None
    alone = strongest_wave(values, harmonics)
    return law(alone["order"]), alone


def wave_parameters(around: Surroundings, order: float, harmonics: int, unit: str | None = None) -> list[Parameter]:
    """Amplitudes, zero to begin with, and the order: periods per turn, or radians per travel where the position is no angle.

    Args:
        unit: of the amplitudes; by default that of a force at the port.
    """
    size = around.force_unit if unit is None else unit
    per_travel, what = order_told(around.units.get("position", ""))
    told = {"a": "cosine amplitude", "b": "sine amplitude"}
    waves = [(n, k) for k in range(1, harmonics + 1) for n in amplitudes(k)]
    return [
        *(Parameter(n, 0.0, size, description=f"{told[n[0]]}{f' at {k} orders' if k > 1 else ''}") for n, k in waves),
        Parameter("order", order, per_travel, lower=order / OCTAVE, upper=OCTAVE * order, description=what),
    ]


def drawn_within(order: float, unit_of_position: str) -> float:
    """The travel over which a sum of waves is drawn: the whole number of periods that is nearest to a turn, or one where positions are no
    angles.
    """
    period = 2 * math.pi / abs(order)
    is_turned = order_told(unit_of_position)[0] == ""
    return period * max(1, round(abs(order))) if is_turned else period


def waves(position: Any, p: Signals, harmonics: int) -> Any:
    """a cos nθ + b sin nθ + Σ a_k cos knθ + b_k sin knθ."""
    total = 0.0
    for k in range(1, harmonics + 1):
        angle, (cosine, sine) = k * p.order * position, amplitudes(k)
        total = total + p[cosine] * torch.cos(angle) + p[sine] * torch.sin(angle)
    return total


def slope_of_waves(position: Any, p: Signals, harmonics: int) -> Any:
    """The derivative of :func:`waves` by the position."""
    total = 0.0
    for k in range(1, harmonics + 1):
        angle, (cosine, sine) = k * p.order * position, amplitudes(k)
        total = total + k * p.order * (p[sine] * torch.cos(angle) - p[cosine] * torch.sin(angle))
    return total
