"""The library of the sparse regression: functions of the signals at a port, and the mechanism that each speaks for.

A regression finds terms, not mechanisms; the mapping is the reader's. The one here is generous: every term that a mechanism of the contract
would bring about speaks for it. What it cannot hold is memory: lags, delays, bristles, hysteresis and further masses are functions of no
signal that is there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import torch

from greybox_torch import Signals, Surroundings

ORDERS = range(2, 9)
"""Periods per turn of the periodic terms beside the first."""


@dataclass(frozen=True)
class Term:
    """One column: ``value`` of the local signals; ``positive`` and ``negative`` are what a coefficient of that sign speaks for.

    An empty name speaks for nothing: the plain model has such a term already, its coefficient is a parameter that is off.
    """

    name: str
    needs: tuple[str, ...]
    value: Callable[[Signals], Any]
    positive: str
    negative: str

    def speaks_for(self, coefficient: float) -> str:
        return self.positive if coefficient > 0 else self.negative


def terms(kind: str, around: Surroundings) -> list[Term]:
    """The library for a port of ``kind``, as far as its signals are there."""
    build = {"body": _body, "coupling": _coupling, "balance": _balance, "actuator": _actuator}[kind]
    return [t for t in build(around) if set(t.needs) <= set(around.ranges)]


def _term(name: str, needs: str, value: Callable[[Signals], Any], positive: str, negative: str | None = None) -> Term:
    return Term(name, tuple(needs.split()), value, positive, positive if negative is None else negative)


def _is_angle(around: Surroundings) -> bool:
    return around.units.get("position", "") in ("rad", "")


def _body(around: Surroundings) -> Iterator[Term]:
    reach = around.ranges["speed"].reach
    sign = _sign(0.03 * reach)
    yield _term("1", "speed", lambda s: torch.ones_like(s.speed), "constant_bias")
    yield _term("v", "speed", lambda s: s.speed, "viscous_friction")
    yield _term("v |v|", "speed", lambda s: s.speed * abs(s.speed), "quadratic_drag")
    yield _term("v^2", "speed", lambda s: s.speed**2, "unknown")
    for share in (0.005, 0.03, 0.1):
        yield _term(f"tanh(v / {share:g} v_max)", "speed", _sign(share * reach), "coulomb_friction")
    for share in (0.05, 0.15):
        yield _term(
            f"exp(-(v / {share:g} v_max)^2) sign v", "speed", _peak(share * reach, 0.03 * reach), "stribeck_friction"
        )
    yield _term("|sign v|", "speed", lambda s, f=sign: abs(f(s)), "coulomb_asymmetry")
    yield _term("|load| sign v", "speed load", lambda s, f=sign: f(s) * abs(s.load), "load_dependent_friction")
    total = around.ranges["time"].span
    for share in (0.15, 0.5):
        yield _term(
            f"exp(-t / {share:g} t_max) sign v", "speed time",
            lambda s, f=sign, T=share * total: f(s) * torch.exp(-s.time / T), "friction_warmup",
        )  # fmt: skip
    yield from _by_position(around, "gravity", "torque_ripple")
    if "position" in around.ranges and _is_angle(around):
        for order in (1, *ORDERS[:3]):
            for name, wave in (("cos", torch.cos), ("sin", torch.sin)):
                yield _term(
                    f"{name}({order} θ) sign v", "speed position",
                    lambda s, f=sign, w=wave, n=order: f(s) * w(n * s.position),
                    "position_dependent_friction",
                )  # fmt: skip
    if "position" in around.ranges:
        yield from _stops(around)


def _by_position(around: Surroundings, once: str, often: str) -> Iterator[Term]:
    """Waves over the position, where that is an angle."""
    if "position" not in around.ranges or not _is_angle(around):
        return
    for order in (1, *ORDERS):
        mechanism = once if order == 1 else often
        yield _term(f"cos({order} θ)", "position", lambda s, n=order: torch.cos(n * s.position), mechanism)
        yield _term(f"sin({order} θ)", "position", lambda s, n=order: torch.sin(n * s.position), mechanism)


def _stops(around: Surroundings) -> Iterator[Term]:
    """Ramps over the outer tenths of the travel."""
    low, span = around.ranges["position"].low, around.ranges["position"].span
    yield _term("ramp above", "position", lambda s: torch.clamp(s.position - low - 0.9 * span, min=0.0), "end_stop")
    yield _term("ramp below", "position", lambda s: torch.clamp(low + 0.1 * span - s.position, min=0.0), "end_stop")


def _coupling(around: Surroundings) -> Iterator[Term]:
    reach, fast = around.ranges["deflection"].reach, around.ranges["rate"].reach
    yield _term("1", "deflection", lambda s: torch.ones_like(s.deflection), "")
    yield _term("δ", "deflection", lambda s: s.deflection, "")
    yield _term("r", "rate", lambda s: s.rate, "")
    yield _term("δ |δ|", "deflection", lambda s: s.deflection * abs(s.deflection), "nonlinear_stiffness")
    yield _term("δ^3", "deflection", lambda s: s.deflection**3, "nonlinear_stiffness")
    for share in (0.03, 0.1, 0.3):  # a dead zone is a spring less a saturated one
        yield _term(
            f"tanh(δ / {share:g} δ_max)", "deflection", lambda s, w=share * reach: torch.tanh(s.deflection / w),
            "nonlinear_stiffness", "backlash",
        )  # fmt: skip
    yield _term("r |r|", "rate", lambda s: s.rate * abs(s.rate), "nonlinear_damping")
    for share in (0.03, 0.1):
        yield _term(
            f"tanh(r / {share:g} r_max)", "rate", lambda s, w=share * fast: torch.tanh(s.rate / w), "nonlinear_damping"
        )
    yield from _by_position(around, "transmission_error", "transmission_error")


def _balance(around: Surroundings) -> Iterator[Term]:
    low, span = around.ranges["level"].low, around.ranges["level"].span
    yield _term("1", "level", lambda s: torch.ones_like(s.level), "constant_bias")
    yield _term("h", "level", lambda s: s.level, "linear_leak")
    for share in (0.3, 0.6, 0.8):
        yield _term(
            f"h above {share:g}", "level", lambda s, c=low + share * span: torch.clamp(s.level - c, min=0.0), "threshold_flow"
        )  # fmt: skip


def _actuator(around: Surroundings) -> Iterator[Term]:
    reach = around.ranges["input"].reach
    yield _term("1", "input", lambda s: torch.ones_like(s.input), "input_bias")
    yield _term("u", "input", lambda s: s.input, "input_gain")
    yield _term("u |u|", "input", lambda s: s.input * abs(s.input), "torque_saturation")
    yield _term("u^3", "input", lambda s: s.input**3, "torque_saturation")
    for share in (0.02, 0.05):
        yield _term(
            f"tanh(u / {share:g} u_max)",
            "input",
            lambda s, w=share * reach: torch.tanh(s.input / w),
            "actuator_deadzone",
        )
    yield _term("u |v|", "input speed", lambda s: s.input * abs(s.speed), "unknown")
    yield _term("u v", "input speed", lambda s: s.input * s.speed, "unknown")


def _sign(width: float) -> Callable[[Signals], Any]:
    return lambda s: torch.tanh(s.speed / width)


def _peak(reach: float, width: float) -> Callable[[Signals], Any]:
    return lambda s: torch.exp(-((s.speed / reach) ** 2)) * torch.tanh(s.speed / width)
