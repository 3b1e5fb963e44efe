"""A lag of first or of second order, of an input or of an output."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import torch

from greybox_torch.mechanisms.degenerate import too_long
from greybox_torch.mechanisms.mechanism import SHARE, Mechanism, Probe, Surroundings
from greybox_torch.mechanisms.short_lag import SHORTEST, lag_change, lag_rate
from greybox_torch.model import Parameter, Signals, State


class Lag(Mechanism):
    """T dw/dt = s − w of a signal s; with ``second_order`` (T/2ζ)² d²w/dt² + T dw/dt = s − w, with the damping ratio ζ.

    In both forms T is the mean delay. A damping of 1 is two equal time constants T/2, one of 0.7 a Butterworth filter. Lags shorter than a
    few samples are followed no faster than the sampling shows: there the damping says nothing.
    """

    fades = True
    linear = True
    natural = ("damping.upper",)
    nature = "a time shift"
    source = "L. Ljung, System Identification, 2nd ed., 1999"
    looks: tuple[int, ...]
    """Time constants that the screen looks at, in samples."""
    acting: str
    """Where w acts, in words."""
    symbol: str
    """The signal's, in the formula."""

    def __init__(self, second_order: bool = False) -> None:
        self.second_order = second_order

    def described_here(self) -> str:
        second = "(T/(2 damping))² d²w/dt² + " if self.second_order else ""
        return f"{self.acting}: {second}T dw/dt = {self.symbol} − w"

    def parameters(self, around: Surroundings) -> list[Parameter]:
        step = around.sample_time
        told = "mean delay" if self.second_order else "time constant"
        time = Parameter("T", 3 * step, "s", lower=0.0, upper=2000 * step, description=told)
        damping = Parameter("damping", 1.0, "", lower=0.1, upper=2.0, description="1: two equal time constants")
        return [time, damping] if self.second_order else [time]

    def states(self, around: Surroundings) -> list[State]:
        unit = self.unit(around)
        slope = State("slope", f"{unit}/s" if unit else "")
        return [State("lagged", unit), slope] if self.second_order else [State("lagged", unit)]

    def starts(self, s: Signals) -> dict[str, Any]:
        signal = s[self.needs[0]]
        return {"lagged": signal, "slope": 0.0 * signal} if self.second_order else {"lagged": signal}

    def rates(self, s: Signals, p: Signals, z: Signals) -> dict[str, Any]:
        signal = s[self.needs[0]]
        if not self.second_order:
            return {"lagged": lag_rate(signal, z.lagged, p.T, s.sample_time)}
        shortest = SHORTEST * s.sample_time
        time = torch.clamp(p.T, min=shortest)
        # Shorter than a few samples it is no faster than the integrator follows: there the damping no longer counts.
        square = torch.maximum((0.5 * time / p.damping) ** 2, shortest * time)
        return {"lagged": z.slope, "slope": (signal - z.lagged - time * z.slope) / square}

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return lag_change(s[self.needs[0]], z.lagged, p.T, s.sample_time)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        further = {"damping": 1.0} if self.second_order else {}
        return [Probe((SHARE,), {"T": samples * around.sample_time, **further}) for samples in self.looks]

    def amplitudes(self, around: Surroundings) -> tuple[str, ...]:
        return ("T",)  # without it there is no lag, however it is damped

    def richer(self, values: Mapping[str, float]) -> Sequence[tuple[Mechanism, Mapping[str, float]]]:
        return () if self.second_order else ((type(self)(True), {**values, "damping": 1.0}),)

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        return too_long("T", values["T"], around)

    def unit(self, around: Surroundings) -> str:
        """The unit of the signal."""
        raise NotImplementedError
