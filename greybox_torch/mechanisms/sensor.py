"""The way from the true output to the recorded one: delay, lag, bias, gain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import torch

from greybox_torch.mechanisms.degenerate import too_long
from greybox_torch.mechanisms.lag import Lag
from greybox_torch.mechanisms.linear_law import LinearLaw, Of
from greybox_torch.mechanisms.mechanism import SHARE, Mechanism, Probe, Surroundings
from greybox_torch.model import Parameter, Signals, State

FOLLOWED = 1.6
"""Samples of the shortest dead time whose approximation one step of the integrator per sample follows: its poles lie at 3.5 / T."""


class _LateBesideOthers(Mechanism):
    """What is late beside something: not where no input moves and nothing else is recorded.

    A motion that is left to itself is late beside nothing, and how a sensor follows it is how the machine may move. Seen: a car that
    coasts down, its viscous friction told as a lag of its speed sensor, 9.7 s (0.97).
    """

    def available(self, around: Surroundings) -> bool:
        return super().available(around) and around.timed


class SensorLag(_LateBesideOthers, Lag):
    """w is recorded in the place of the output y: T dw/dt = y − w; with ``second_order`` (T/2ζ)² d²w/dt² + T dw/dt = y − w.

    See :class:`Lag`; ζ is the damping ratio, and T in both forms the mean delay.
    """

    name = "sensor_lag"
    kinds = ("sensor",)
    needs = ("output",)
    akin = ("input_lag",)
    explanation = "The output is recorded through a lag (filter, sensor dynamics)."
    experiment = "a second sensor, or a known motion"
    looks = (2, 6, 20)
    acting, symbol = "w is recorded in the place of the output y", "y"

    def unit(self, around: Surroundings) -> str:
        return around.units.get("output", "")


class OutputDelay(_LateBesideOthers):
    """The output is recorded later by a dead time T, as its second-order Padé approximation (1 − sT/2 + s²T²/12)/(1 + sT/2 + s²T²/12).

    What it shows first is what was before the record, which nobody knows: windows do not count that, for two dead times.

    Its two states are carried from window to window, short as their memory is: free in every one they would take up a tenth of the noise
    in windows of 20 samples, and a delay of the output would look likelier than one of the input, or a lag.
    """

    name = "output_delay"
    kinds = ("sensor",)
    needs = ("output",)
    settling = 2.0
    linear = True
    twins = ("input_delay",)
    natural = ("T.lower",)
    nature = "a time shift"
    explanation = "The output is recorded after a dead time (sampling, bus, filter)."
    source = "H. Padé, 1892; L. Ljung, System Identification, 2nd ed., 1999"
    experiment = "an input whose own timing is known; without one a delay of the output is a delay of the input"

    def parameters(self, around: Surroundings) -> list[Parameter]:
        step = around.sample_time
        return [Parameter("T", 4 * step, "s", lower=0.5 * step, upper=500 * step, description="dead time")]

    def states(self, around: Surroundings) -> list[State]:
        unit = around.units.get("output", "")
        return [State("filtered", unit), State("slope", f"{unit}/s" if unit else "")]

    def starts(self, s: Signals) -> dict[str, Any]:
        return {"filtered": s.output}

    def rates(self, s: Signals, p: Signals, z: Signals) -> dict[str, Any]:
        # A shorter one is followed no faster than the integrator does: its mean is T all the same, as the force is T times the slope.
        time = torch.clamp(p.T, min=FOLLOWED * s.sample_time)
        return {"filtered": z.slope, "slope": 12 / time**2 * (s.output - z.filtered - 0.5 * time * z.slope)}

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return -p.T * z.slope

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe((SHARE,), {"T": factor * around.sample_time}) for factor in (3, 8, 24)]

    def richer(self, values: Mapping[str, float]) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        """A filter of second order, which a dead time comes nearer to than a filter of first order does."""
        return ((SensorLag(True), {**values, "damping": 1.0}),)

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        return too_long("T", values["T"], around)


class SensorBias(LinearLaw):
    """The recorded output is off by a constant."""

    name = "sensor_bias"
    kinds = ("sensor",)
    nature = "a constant offset"
    explanation = "The recorded output is off by a constant (sensor offset)."
    source = "J. J. Craig, Introduction to Robotics, 3rd ed., 2005"
    experiment = "a record at standstill"
    parameter, measured_in, description = "bias", Of("output"), "offset"

    def law(self, s: Signals, size: Any) -> Any:
        return size


class SensorGain(LinearLaw):
    """The recorded output is (1 + gain_error) y."""

    name = "sensor_gain"
    kinds = ("sensor",)
    needs = ("output",)
    linear = True
    scales = True
    nature = "another gain than recorded"
    explanation = "The output is recorded with another gain (scale factor)."
    source = "J. J. Craig, Introduction to Robotics, 3rd ed., 2005"
    experiment = "a second sensor, or a known motion"
    parameter, measured_in, lower, upper, description = "gain_error", Of(), -0.9, 9.0, "relative error of the gain"

    def law(self, s: Signals, size: Any) -> Any:
        return size * s.output
