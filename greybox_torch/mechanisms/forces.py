"""Other forces on a body: a constant, and those of one more mass."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch

from greybox_torch.mechanisms.degenerate import not_a_frequency_of_the_record
from greybox_torch.mechanisms.linear_law import LinearLaw, Per
from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
from greybox_torch.model import Parameter, Signals, State

HIGHEST = 0.3
"""Highest frequency of a mode in shares of the Nyquist frequency."""

RIGID = 0.95
"""Share of the highest frequency from which a mode is none: its mass moves with the body, as a gain of what drives it would say as well."""

FAR_ABOVE = 2.0
"""Times the highest frequency of the inputs, where nothing rings: modes were told at 3 and more for gains, real ones are below 0.8."""


BIAS_OR_ASYMMETRY = (
    "standstill and reversals without load: a bias pushes at rest, an asymmetry does not; where dry friction holds it, no recording "
    "tells one from the other"
)
"""In motion both are one and the same constant force."""


class ConstantBias(LinearLaw):
    """A constant b."""

    name = "constant_bias"
    kinds = ("body", "balance")
    akin = ("input_bias",)
    nature = "a constant offset"
    explanation = "Something constant acts: a force (offset of an amplifier, unbalanced weight, preload), or a flow of heat or of a fluid."
    source = "A. Janot, M. Gautier, M. Brunot, Data set and reference models of EMPS, 2019"
    experiment = BIAS_OR_ASYMMETRY
    parameter, measured_in, description = "bias", Per(), "constant force"

    def law(self, s: Signals, size: Any) -> Any:
        return size


class AdditionalMode(Mechanism):
    """A further ``mass`` m on the body by a spring m ω² and a damper 2 ζ ω m."""

    name = "additional_mode"
    kinds = ("body",)
    needs = ("speed",)
    linear = True
    lasting = ("stretch", "speed")  # a recording that is cut out of a motion begins with a mode that rings
    generalises = ("viscous_friction",)  # of a heavy mass by a soft spring the damper is seen
    essential = ("mass",)  # of one so heavy that the body does not move it the spring is seen, and no mode
    natural = ("zeta",)
    nature = "one more mass on a spring"
    explanation = "One more mass hangs on this body by a spring and a damper (an unmodelled resonance)."
    source = "E. Wernholt, S. Gunnarsson, SYSID 2006; J. P. Den Hartog, Mechanical Vibrations, 1956"
    experiment = "broadband excitation around the resonance"

    def parameters(self, around: Surroundings) -> list[Parameter]:
        place = around.units.get("speed", "").replace("/s", "")
        unit = f"{around.force_unit} s^2/{place}" if place else ""
        nyquist = torch.pi / around.sample_time
        return [
            Parameter("mass", 0.0, unit, lower=0.0, description="mass or inertia"),
            Parameter(
                "omega", 0.02 * nyquist, "rad/s", lower=2e-4 * nyquist, upper=HIGHEST * nyquist, description="frequency"
            ),
            Parameter("zeta", 0.05, "", lower=1e-3, upper=2.0, description="damping ratio"),
        ]

    def states(self, around: Surroundings) -> list[State]:
        unit = around.units.get("speed", "")
        return [State("stretch", unit.replace("/s", "")), State("speed", unit)]

    def starts(self, s: Signals) -> dict[str, Any]:
        return {"speed": s.speed}

    def rates(self, s: Signals, p: Signals, z: Signals) -> dict[str, Any]:
        relative = z.speed - s.speed
        return {"stretch": relative, "speed": -(p.omega**2) * z.stretch - 2 * p.zeta * p.omega * relative}

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return p.mass * (p.omega**2 * z.stretch + 2 * p.zeta * p.omega * (z.speed - s.speed))

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        """So near to one another that one lies within the width of a resonance of a few percent damping: farther off, no refit finds it."""
        nyquist = torch.pi / around.sample_time
        shares = 0.002 * (0.11 / 0.002) ** (np.arange(28) / 27)
        return [Probe(("mass",), {"omega": float(share) * nyquist, "zeta": 0.05}) for share in shares]

    def begun_elsewhere(self, around: Surroundings, values: Mapping[str, float]) -> Sequence[Mapping[str, float]]:
        """Half a decade below and above: between a mass that moves along and a resonance the error has a valley of its own."""
        nyquist = torch.pi / around.sample_time
        there = (values["omega"] * factor for factor in (1 / 3, 3.0))
        return [{"omega": w, "zeta": 0.05} for w in there if 2e-4 * nyquist < w < HIGHEST * nyquist]

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        if values["zeta"] >= 1.0:
            return f"its damping ratio of {values['zeta']:.3g} lets nothing resonate"
        return not_a_frequency_of_the_record("omega", values["omega"], around) or _rigid(values["omega"], around)


def _rigid(omega: float, around: Surroundings) -> str | None:
    """A mode has the highest frequency that it may have, in rad/s, or one far above what the inputs excite: nothing makes it ring."""
    highest, with_body = HIGHEST * np.pi / around.sample_time, "its mass moves with the body"
    if omega > RIGID * highest:
        return f"omega = {omega:.3g} rad/s is at its most, {highest:.3g} rad/s: {with_body}"
    if omega > FAR_ABOVE * around.excited:
        return f"omega = {omega:.3g} rad/s is far above what the inputs excite, up to {around.excited:.3g} rad/s: {with_body}"
    return None
