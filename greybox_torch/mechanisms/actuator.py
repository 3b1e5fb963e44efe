"""The way from the recorded input to the input that acts: delay, lag, bias, gain, saturation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import torch

from greybox_torch.mechanisms.by_direction import ByDirection, larger_forms
from greybox_torch.mechanisms.degenerate import too_long
from greybox_torch.mechanisms.lag import Lag
from greybox_torch.mechanisms.linear_law import LinearLaw, Of, Per
from greybox_torch.mechanisms.mechanism import SHARE, Mechanism, Probe, Surroundings
from greybox_torch.mechanisms.soft_limit import log_of_limited
from greybox_torch.mechanisms.surroundings import Range
from greybox_torch.model import Parameter, Signals

PEAKS = 8.0
"""How many times its root mean square an input is at most, but for peaks that say nothing of where it usually is."""


class InputLag(Lag):
    """w acts in the place of the input u: T dw/dt = u − w; with ``second_order`` (T/2ζ)² d²w/dt² + T dw/dt = u − w.

    See :class:`Lag`; ζ is the damping ratio, and T in both forms the mean delay.
    """

    name = "input_lag"
    kinds = ("actuator",)
    needs = ("input",)
    akin = ("sensor_lag",)
    explanation = "The input acts through a lag (current loop, valve)."
    experiment = "a step or a chirp of the input, to tell a lag from a delay"
    looks = (2, 6, 20, 60)
    acting, symbol = "w acts in the place of the input u", "u"

    def unit(self, around: Surroundings) -> str:
        return around.force_unit


class InputDelay(Mechanism):
    """The input acts later by a dead time: u(t − T).

    With further ``drives``, inputs of the model, all of them do, by the same time: the computer or the bus before them is late.
    """

    name = "input_delay"
    kinds = ("actuator",)
    needs = ("input", "delayed")
    linear = True
    twins = ("output_delay",)
    nature = "a time shift"
    explanation = "The input acts after a dead time (computation, bus, transport)."
    source = "L. Ljung, System Identification, 2nd ed., 1999"
    experiment = "a step or a chirp of the input, to tell a lag from a delay"

    def __init__(self, drives: Sequence[str] = ()) -> None:
        self.drives = tuple(drives)

    def parameters(self, around: Surroundings) -> list[Parameter]:
        step = around.sample_time
        told = "dead time, of all inputs alike" if self.drives else "dead time"
        return [Parameter("T", 2 * step, "s", lower=0.0, upper=500 * step, description=told)]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return s.delayed - s.input

    def other_inputs(self, s: Signals, p: Signals, z: Signals) -> dict[str, Any]:
        return {name: s[f"delayed@{name}"] - s[f"input@{name}"] for name in self.drives}

    def richer(self, values: Mapping[str, float]) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        """A lag of second order, which a dead time comes nearer to than a lag of first order does."""
        return () if self.drives else ((InputLag(True), {**values, "damping": 1.0}),)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe((SHARE,), {"T": factor * around.sample_time}) for factor in (2, 6, 20, 60)]

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        return too_long("T", values["T"], around)


class InputBias(LinearLaw):
    """The input that acts is off by a constant."""

    name = "input_bias"
    kinds = ("actuator",)
    nature = "a constant offset"
    explanation = "The input that acts is off by a constant (amplifier offset)."
    source = "A. Janot, M. Gautier, M. Brunot, Data set and reference models of EMPS, 2019"
    experiment = "a record with zero input"
    parameter, measured_in, description = "bias", Per(), "offset"

    def law(self, s: Signals, size: Any) -> Any:
        return size


class InputGain(LinearLaw):
    """The input that acts is (1 + gain_error) u."""

    name = "input_gain"
    kinds = ("actuator",)
    needs = ("input",)
    linear = True
    scales = True
    nature = "another gain than recorded"
    explanation = "The input acts with another gain than recorded (current sensor, torque constant)."
    source = "M. Gautier, S. Briot, J. Dyn. Sys. Meas. Control 136, 2014"
    experiment = "a known load: from force to motion a gain cannot be told from mass and friction"
    parameter, measured_in, lower, upper, description = "gain_error", Of(), -0.9, 9.0, "relative error of the gain"

    def law(self, s: Signals, size: Any) -> Any:
        return size * s.input


NEARLY_CLAMP = 0.05
"""Softness below which a limit is a clamp but for its corner."""


class TorqueSaturation(ByDirection):
    """The input that acts is limited: u / (1 + |u / limit|^n)^(1/n), with n = 1 / ``softness``.

    As soft as iron that saturates (a softness of 0.3 to 1), or a clamp (a softness of zero). ``by_direction``, with an ``asymmetry`` a, the
    limit l is (1 + a) ``limit`` for positive inputs and (1 − a) ``limit`` for negative ones. With ``limited_power`` it falls as 1 / speed
    beyond a ``base_speed`` of the first body of the model, as that of a drive whose voltage or battery gives no more power.
    """

    name = "torque_saturation"
    kinds = ("actuator",)
    needs = ("input",)
    essential = ("limit",)
    later = ("softness",)
    nature = "an input that acts in part only"
    explanation = "The input that acts is limited (current limit, valve fully open, iron that saturates)."
    source = "H. K. Khalil, Nonlinear Systems, 3rd ed., 2002"
    experiment = "large inputs of both signs"

    def __init__(self, by_direction: bool = False, limited_power: bool = False) -> None:
        super().__init__(by_direction)
        self.limited_power = limited_power
        if limited_power:
            self.needs = ("input", "speed")
            self.experiment = "large inputs of both signs, at low and at high speed"  # type: ignore[misc]

    def described_here(self) -> str:
        differs = "; limit is (1 + asymmetry) times that above zero and (1 − asymmetry) times that below"
        falls = "; beyond base_speed it falls as 1 / speed"
        return f"{self.described()}{differs if self.by_direction else ''}{falls if self.limited_power else ''}"

    def parameters(self, around: Surroundings) -> list[Parameter]:
        reach, usual = around.ranges["input"].reach, _usual(around.ranges["input"])
        return [
            Parameter("limit", 0.8 * reach, around.force_unit, lower=0.02 * usual, upper=reach, description="limit"),
            Parameter("softness", 0.0, "", lower=0.0, upper=1.0, description="0: a clamp, 0.5: a gradual limit"),
            *self.asymmetry("the limits"),
            *([_base_speed(around)] if self.limited_power else []),
        ]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        limit = p.limit * (1 + p.asymmetry * torch.sign(s.input)) if self.by_direction else p.limit
        if self.limited_power:
            limit = limit / torch.clamp(torch.abs(s.speed) / p.base_speed, min=1.0)
        return s.input * torch.expm1(log_of_limited(s.input / limit, p.softness))

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        spread = around.ranges["input"]
        below = (0.03, 0.1, 0.3) if _usual(spread) < spread.reach else ()
        hard = [factor * spread.rms for factor in (*below, 1.0, 1.5, 2.0, 2.7)]
        soft = [factor * spread.rms for factor in (1.5, 3.0)]
        own = {"asymmetry": 0.0} if self.by_direction else {}
        own |= {"base_speed": _base_speed(around).value} if self.limited_power else {}
        return [
            Probe((SHARE,), {"limit": limit, "softness": softness, **own})
            for softness, limits in ((0.05, hard), (0.4, soft))
            for limit in limits
            if limit < spread.reach
        ]

    def richer(self, values: Mapping[str, float]) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        """With limits that differ by direction, with limited power, whose base speed begins as it is declared, and with both."""
        further = larger_forms((self.by_direction, self.limited_power))
        return [(TorqueSaturation(*f), {**({"asymmetry": 0.0} if f[0] else {}), **values}) for f in further]

    def acts_beyond(self, values: Mapping[str, float]) -> tuple[float | None, float | None] | None:
        """Beyond its limits, if it is nearly a clamp whose limits are the same at all speeds."""
        if self.limited_power or values["softness"] >= NEARLY_CLAMP:
            return None
        limit, differs = values["limit"], values.get("asymmetry", 0.0)
        return -(1.0 - differs) * limit, (1.0 + differs) * limit

    def degenerate(
        self, around: Surroundings, values: Mapping[str, float], deviations: Mapping[str, float]
    ) -> str | None:
        """A limit at the largest input that is nearly a clamp rounds its tips off: there it lets pass what a clamp of that height does."""
        nearly_clamp = 0.0 < values["softness"] < NEARLY_CLAMP
        height = values["limit"] * (2.0 ** -values["softness"] if nearly_clamp else 1.0)
        return super().degenerate(around, {**values, "limit": height}, deviations)


def _base_speed(around: Surroundings) -> Parameter:
    """Beyond all that was recorded it would say nothing."""
    reach, told = around.ranges["speed"].reach, "beyond it the limit falls as 1 / speed, at constant power"
    return Parameter(
        "base_speed", 0.5 * reach, around.units.get("speed", ""), lower=0.02 * reach, upper=reach, description=told
    )


def _usual(spread: Range) -> float:
    """The largest magnitude of an input, or some times its root mean square where that is far less, as of a controller's output that peaks.

    Seen: a crane's current, logged as its controller asked for it: 3032 A once, 180 A root mean square, and 10 A of the drive.
    """
    return min(spread.reach, PEAKS * spread.rms)
