"""Friction on a body whose level varies: with the load, the position, or the time since the start."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import torch

from greybox_torch.mechanisms.degenerate import not_a_time_of_the_record, not_seen_to_repeat
from greybox_torch.mechanisms.linear_law import Of
from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
from greybox_torch.mechanisms.sign_change import DryLaw, smooth_sign, width_parameter, widths
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.mechanisms.waves import HARMONICS, amplitudes_up_to, wave_parameters, waves
from greybox_torch.model import Parameter, Signals


class LoadDependentFriction(DryLaw):
    """−c |load| tanh(v / v_0)."""

    name = "load_dependent_friction"
    kinds = ("body",)
    needs = ("speed", "load")
    drawn_over = "load"
    nature = "dry friction"
    explanation = "Friction grows with the load carried (gear meshes, bearings under force)."
    source = "P. Hamon, M. Gautier, P. Garrec, IEEE/RSJ IROS, 2010; A. C. Bittencourt, S. Gunnarsson, J. Dyn. Sys. Meas. Control 134, 2012"
    experiment = "the same speeds under different loads"
    parameter, measured_in, lower, upper, description = "c", Of(), 0.0, 2.0, "friction per load"

    def law(self, s: Signals, size: Any) -> Any:
        return -size * torch.abs(s.load)


class PositionDependentFriction(Mechanism):
    """−(a cos nθ + b sin nθ) tanh(v / v_0) with an order n, and ``harmonics`` of it: a_k cos knθ + b_k sin knθ.

    ``with_level``, −F_c tanh(v / v_0) besides: for a body whose model has no dry friction.
    """

    name = "position_dependent_friction"
    kinds = ("body",)
    needs = ("speed", "position")
    generalises = ("coulomb_friction",)
    natural = ("v_0",)
    nature = "dry friction"
    explanation = "The friction level varies periodically with position (bent shaft, eccentric bearing)."
    source = "M. R. Popović, A. A. Goldenberg, IEEE Trans. Robotics and Automation 14(1), 1998"
    experiment = "the same positions passed in both directions"

    def __init__(self, order: float = 1.0, harmonics: int = 1, with_level: bool = False) -> None:
        self.order, self.harmonics, self.with_level = order, harmonics, with_level
        if with_level:
            self.includes = ("coulomb_friction",)
            self.stands_for = ("coulomb_friction", "position_dependent_friction")

    def parameters(self, around: Surroundings) -> list[Parameter]:
        level = Parameter("F_c", 0.0, around.force_unit, lower=0.0, description="mean Coulomb level")
        own = [*wave_parameters(around, self.order, self.harmonics), width_parameter(around)]
        return [level, *own] if self.with_level else own

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        varying = waves(s.position, p, self.harmonics)
        return -(p.F_c + varying if self.with_level else varying) * smooth_sign(s.speed, p.v_0)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe(amplitudes_up_to(self.harmonics), {"order": self.order, "v_0": widths(around)[1]})]

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        return not_seen_to_repeat(values["order"], around, once_per_turn=True)

    def richer(self, values: Mapping[str, float]) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        """With harmonics, with a mean level, and as a ripple: where the speed hardly changes its sign the friction is one without."""
        order, forms = values["order"], []
        if self.harmonics == 1:
            wave = {n: values[n] for n in ("a", "b", "order")}
            forms = [
                (PositionDependentFriction(order, HARMONICS, self.with_level), dict(values)),
                (TorqueRipple(order, HARMONICS), wave),
            ]
        if not self.with_level:
            forms.append((PositionDependentFriction(order, self.harmonics, True), {**values, "F_c": 0.0}))
        return forms


class FrictionWarmup(Mechanism):
    """−ΔF exp(−t / T) tanh(v / v_0): Coulomb friction that decays (ΔF > 0) or grows with time.

    ``with_level``, −F_c tanh(v / v_0) besides: for a body whose model has no dry friction.
    """

    name = "friction_warmup"
    kinds = ("body",)
    needs = ("speed", "time")
    natural = ("v_0",)
    nature = "dry friction"
    explanation = "The friction level drifts as the machine warms up."
    source = "A. C. Bittencourt, S. Gunnarsson, J. Dyn. Sys. Meas. Control 134, 2012"
    experiment = "the same motion repeated from cold to warm"

    def __init__(self, with_level: bool = False) -> None:
        self.with_level = with_level
        if with_level:
            self.includes = self.generalises = ("coulomb_friction",)
            self.stands_for = ("coulomb_friction", "friction_warmup")

    def parameters(self, around: Surroundings) -> list[Parameter]:
        total = max(around.ranges["time"].high, around.sample_time)
        level = Parameter("F_c", 0.0, around.force_unit, lower=0.0, description="level in the end")
        return [
            *([level] if self.with_level else []),
            Parameter("delta", 0.0, around.force_unit, description="level at the start above the final one"),
            Parameter("T", 0.3 * total, "s", lower=0.02 * total, upper=5 * total, description="time constant"),
            width_parameter(around),
        ]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        passing = p.delta * torch.exp(-s.time / p.T)
        return -(p.F_c + passing if self.with_level else passing) * smooth_sign(s.speed, p.v_0)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        total = max(around.ranges["time"].high, around.sample_time)
        return [
            Probe(("delta",), {"T": share * total, "v_0": width})
            for share in (0.1, 0.3, 1.0)
            for width in widths(around)[:2]
        ]

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        return not_a_time_of_the_record("T", values["T"], around)

    def richer(self, values: Mapping[str, float]) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        """With the level that stays."""
        return () if self.with_level else ((FrictionWarmup(with_level=True), {**values, "F_c": 0.0}),)
