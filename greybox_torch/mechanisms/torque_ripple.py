"""A force that repeats over a turn: cogging, commutation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch

from greybox_torch.mechanisms.degenerate import is_angle, not_seen_to_repeat
from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
from greybox_torch.mechanisms.order_of_curve import order_of_curve
from greybox_torch.mechanisms.waves import (
    HARMONICS,
    amplitudes,
    amplitudes_up_to,
    strongest_alone,
    strongest_wave,
    wave_parameters,
    waves,
)
from greybox_torch.model import Parameter, Signals

LIKE_WEIGHT = 0.02
"""By how much an order may differ from once per turn for a ripple to be no other law than weight: what a model lacks shifts it so far."""


class TorqueRipple(Mechanism):
    """a cos nθ + b sin nθ with an order n above one, and ``harmonics`` of it: a_k cos knθ + b_k sin knθ."""

    name = "torque_ripple"
    kinds = ("body",)
    needs = ("position",)
    repeats = True
    nature = "a force that depends on position"
    explanation = "The drive's force varies periodically with position (cogging, commutation)."
    source = "T. M. Jahns, W. L. Soong, IEEE Trans. Industrial Electronics 43(2), 1996"
    experiment = "slow constant speed over several turns, in both directions"

    def __init__(self, order: float = 2.0, harmonics: int = 1) -> None:
        self.order, self.harmonics = order, harmonics

    def parameters(self, around: Surroundings) -> list[Parameter]:
        return wave_parameters(around, self.order, self.harmonics)

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return waves(s.position, p, self.harmonics)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe(amplitudes_up_to(self.harmonics), {"order": self.order})]

    def richer(self, values: Mapping[str, float]) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        """With harmonics of the order found, and as the second harmonic of half of it, or the third of a third of it."""
        if self.harmonics > 1:
            return ()

        def as_harmonic(k: int) -> tuple[TorqueRipple, Mapping[str, float]]:
            base = values["order"] / k
            found = dict(zip(amplitudes(k), (values["a"], values["b"]), strict=True))
            return TorqueRipple(base, 2 * HARMONICS), {"order": base, **found}

        return (TorqueRipple(values["order"], HARMONICS), dict(values)), as_harmonic(2), as_harmonic(3)

    def plainer(self, values: Mapping[str, float]) -> tuple[Mechanism, Mapping[str, float]] | None:
        """Its strongest wave alone: of a ripple of order 4 that was taken for order 2 and harmonics, that is the second."""
        return strongest_alone(TorqueRipple, values, self.harmonics)

    def nearest(
        self, around: Surroundings, signals: Mapping[str, torch.Tensor], force: np.ndarray, weight: np.ndarray
    ) -> Mechanism:
        order = order_of_curve(signals["position"].numpy(), force, weight)
        return self if order is None else TorqueRipple(order)

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        strongest = strongest_wave(values, self.harmonics)["order"]  # of orders 2 and 3, not the first
        if is_angle(around) and abs(strongest - 1.0) < LIKE_WEIGHT:
            return f"order = {strongest:.4g}: once per turn is what weight does"
        return not_seen_to_repeat(values["order"], around)
