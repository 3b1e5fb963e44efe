"""A dynamic residual of one signal: the ceiling and the answer `unknown` where what is missing depends on the past."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from greybox_torch.mechanisms.degenerate import not_a_frequency_of_the_record, not_a_time_of_the_record
from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Parameter, Signals, State

SHORTEST_SOUGHT, TIMES = 4.0, 8
"""Samples of the shortest time constant that is looked for, and how many are, up to a third of the longest record."""

FREQUENCIES = 6
"""Natural frequencies that a residual of two states is looked for with."""

DAMPING = 0.3
"""Damping ratio that it is looked for with."""


class UnknownWithMemory(Mechanism):
    """A filter of the local signal s, of one or two hidden states; the force is what it gives.

    One state: direct s + remembered z, with T dz/dt = s − z. Two states: direct s + remembered z + swing r, with dz/dt = ω r and
    dr/dt = ω (s − z) − 2 ζ ω r. The hidden states begin settled: as if the signal had always been what it is first.

    With ``knots`` a free curve stands in front: the force is z, with T dz/dt = f(s) − z (a Hammerstein model), f a curve as
    :class:`Unknown` draws it. It begins without any force.

    ``direct`` is held weakly towards zero, since the model's own parameters may do the same.
    """

    name = "unknown_with_memory"
    kinds = ("body", "coupling", "balance", "actuator")
    free = True
    linear = True
    essential = ("remembered", "swing")
    natural = ("zeta",)
    explanation = (
        "Something repeatable is missing here that depends on the past; its response shows how long it remembers."
    )
    source = "L. Ljung, Model Validation and Model Error Modeling, Åström Symposium on Control, Lund 1999"
    experiment = (
        "steps of several sizes, held until all is settled, and a chirp: to tell the response and whether it is linear"
    )

    def __init__(self, signal: str, modes: int = 1, knots: int = 0) -> None:
        self.signal = signal
        self.modes = modes
        self.knots = knots
        self.in_front = Unknown(signal, knots) if knots else None
        self.lasting = ("z", "r") if modes == 2 and not knots else ("z",)

    def parameters(self, around: Surroundings) -> list[Parameter]:
        unit, step = around.per(self.signal), around.sample_time
        lag = Parameter("T", 10 * step, "s", lower=step, upper=1e4 * step, description="time constant")
        if self.in_front is not None:
            return [*self.in_front.parameters(around), lag]
        gains = [
            Parameter("direct", 0.0, unit, description="gain without memory", shrunk=True),
            Parameter("remembered", 0.0, unit, description="gain of what is remembered"),
        ]
        if self.modes == 1:
            return [*gains, lag]
        nyquist = np.pi / step
        return [
            *gains,
            Parameter("swing", 0.0, unit, description="gain of its rate"),
            Parameter(
                "omega", 0.02 * nyquist, "rad/s", lower=1e-4 * nyquist, upper=0.3 * nyquist, description="frequency"
            ),
            Parameter("zeta", DAMPING, "", lower=1e-2, upper=5.0, description="damping ratio"),
        ]

    def states(self, around: Surroundings) -> list[State]:
        if self.in_front is not None:
            return [State("z", around.force_unit)]
        unit = around.units.get(self.signal, "")
        return [State("z", unit), *([State("r", unit)] if self.modes == 2 else [])]

    def starts(self, s: Signals) -> dict[str, Any]:
        return {} if self.knots else {"z": s[self.signal]}

    def rates(self, s: Signals, p: Signals, z: Signals) -> dict[str, Any]:
        if self.in_front is not None:
            return {"z": (self.in_front.curve(s, p) - z.z) / p.T}
        lag = s[self.signal] - z.z
        if self.modes == 1:
            return {"z": lag / p.T}
        return {"z": p.omega * z.r, "r": p.omega * (lag - 2 * p.zeta * z.r)}

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        if self.knots:
            return z.z
        force = p.direct * s[self.signal] + p.remembered * z.z
        return force + p.swing * z.r if self.modes == 2 else force

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        step = around.sample_time
        longest = max(around.ranges["time"].span / 3 if "time" in around.ranges else 0.0, 2 * SHORTEST_SOUGHT * step)
        if self.modes == 1:
            times = np.geomspace(SHORTEST_SOUGHT * step, longest, TIMES)
            if self.in_front is not None:
                heights = self.in_front.probes(around)[0].directions
                return [Probe(heights, {"T": float(T)}) for T in times[::2]]
            return [Probe(("direct", "remembered"), {"T": float(T)}) for T in times]
        omegas = np.geomspace(6.0 / longest, 1.0 / (SHORTEST_SOUGHT * step), FREQUENCIES)
        return [Probe(("direct", "remembered", "swing"), {"omega": float(omega), "zeta": DAMPING}) for omega in omegas]

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        if self.modes == 1:
            return not_a_time_of_the_record("T", values["T"], around)
        return not_a_frequency_of_the_record("omega", values["omega"], around)

    def signals(self) -> tuple[str, ...]:
        return (self.signal,)

    def seconds(self, values: Mapping[str, float]) -> float:
        """How long it remembers: the longest time constant, in s, after which 37 % of what was is left."""
        if self.modes == 1:
            return values["T"]
        omega, zeta = values["omega"], values["zeta"]
        return 1.0 / (omega * (zeta - np.sqrt(max(zeta**2 - 1.0, 0.0))))

    def response(self, values: Mapping[str, float], omega: np.ndarray) -> np.ndarray:
        """The complex gain (F,) from the signal (or from the curve in front) to the force at angular frequencies (F,) in rad/s."""
        if self.knots:
            return 1.0 / (1.0 + 1j * omega * values["T"])
        if self.modes == 1:
            return values["direct"] + values["remembered"] / (1.0 + 1j * omega * values["T"])
        along = 1j * omega / values["omega"]
        settling = 1.0 + 2 * values["zeta"] * along + along**2
        return values["direct"] + (values["remembered"] + values["swing"] * along) / settling
