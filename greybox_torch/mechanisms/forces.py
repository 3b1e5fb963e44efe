"""Forces on a body that do not depend on its speed: bias, gravity, ripple, end stops, one more mass."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch

from greybox_torch.mechanisms.degenerate import beyond, not_a_frequency_of_the_record
from greybox_torch.mechanisms.linear_law import LinearLaw, Per
from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
from greybox_torch.model import Parameter, Signals, State

KNOWN_PLACE = 0.01
"""Share of the travel within which a stop has to be known to stand."""

STIFFER = (30.0, 1000.0)
"""Times the stiffness that a refit came to with which it begins again, where it is and at the end of the travel: a soft stop that gives way
early and a hard one both turn the body back, and none between them does as well."""

GIVES_WAY = 0.3
"""Share of the travel beyond its place from which a stop is none: of machines whose stops are known 0.09 at the most lies beyond them, a
rubber buffer's; of stops that were told where none is, 0.35."""

GIVES_WAY_UNSEEN = 0.5
"""The same where no sensor shows the position: the travel is that of a model without the stop, which goes farther (0.4 of a valve's)."""

MARGIN = 0.1
"""Share of the travel, as a model without a stop has it, by which the machine may have gone farther before it met one."""

HIGHEST = 0.3
"""Highest frequency of a mode in shares of the Nyquist frequency."""

RIGID = 0.95
"""Share of the highest frequency from which a mode is none: its mass moves with the body, as a gain of what drives it would say as well."""

FAR_ABOVE = 2.0
"""Times the highest frequency of the inputs, where nothing rings: modes were told at 3 and more for gains, real ones are below 0.8."""


class ConstantBias(LinearLaw):
    """A constant b."""

    name = "constant_bias"
    kinds = ("body", "balance")
    akin = ("input_bias",)
    nature = "a constant offset"
    explanation = "Something constant acts: a force (offset of an amplifier, unbalanced weight, preload), or a flow of heat or of a fluid."
    source = "A. Janot, M. Gautier, M. Brunot, Data set and reference models of EMPS, 2019"
    experiment = "standstill and reversals without load: a bias pushes at rest, an asymmetry does not"
    parameter, measured_in, description = "bias", Per(), "constant force"

    def law(self, s: Signals, size: Any) -> Any:
        return size


class EndStop(Mechanism):
    """−k (θ − θ_1) − c ω beyond θ_1 (``side`` +1) or below it (``side`` −1), as long as that pushes back: a stop does not pull."""

    name = "end_stop"
    kinds = ("body",)
    needs = ("position", "speed")
    at_rest = ("speed",)
    nature = "a force that depends on position"
    explanation = "Past a position something stiff pushes back (mechanical stop, cable)."
    source = "F. Pfeiffer, C. Glocker, Multibody Dynamics with Unilateral Contacts, 1996"
    experiment = "slow approach to the ends of travel"

    def parameters(self, around: Surroundings) -> list[Parameter]:
        travel = around.ranges["position"]
        end, margin = travel.low + travel.span, MARGIN * travel.span
        return [
            Parameter("k", 0.0, around.per("position"), lower=0.0, description="stiffness of the stop"),
            Parameter(
                "where",
                end,
                around.units.get("position", ""),
                lower=travel.low - margin,
                upper=end + margin,
                description="stop",
            ),
            Parameter("c", 0.0, around.per("speed"), lower=0.0, description="damping of the stop"),
            Parameter("side", 1.0, "", fixed=True, description="+1: the stop is above, -1: below"),
        ]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        beyond = p.side * (s.position - p.where)
        back = p.k * beyond + p.c * p.side * s.speed
        return -p.side * torch.where((beyond > 0.0) & (back >= 0.0), back, 0.0)

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        travel = around.ranges["position"]
        width = travel.span
        above = [
            Probe(("k",), {"where": travel.high - share * width, "side": 1.0, "c": 0.0}) for share in (0.03, 0.1, 0.25)
        ]
        return above + [
            Probe(("k",), {"where": travel.low + share * width, "side": -1.0, "c": 0.0}) for share in (0.03, 0.1, 0.25)
        ]

    def begun_elsewhere(self, around: Surroundings, values: Mapping[str, float]) -> Sequence[Mapping[str, float]]:
        travel, (stiff, hard) = around.ranges["position"], STIFFER
        end = travel.high if values["side"] > 0 else travel.low
        return [{"k": stiff * values["k"]}, {"k": hard * values["k"], "where": end}]

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        travel, where = around.ranges["position"], values["where"]
        margin = MARGIN * travel.span
        if not travel.low - margin < where < travel.high + margin:
            return beyond("where", where, around, "position")
        passed = (travel.high - where if values["side"] > 0 else where - travel.low) / travel.span
        return (
            f"{100 * passed:.0f} % of the travel lies beyond it: no stop gives way so far"
            if passed > (GIVES_WAY_UNSEEN if "position" in around.unmeasured else GIVES_WAY)
            else None
        )

    def degenerate(
        self, around: Surroundings, values: Mapping[str, float], deviations: Mapping[str, float]
    ) -> str | None:
        """Of a rigid stop no recording tells how stiff it is, only that it is stiff: what counts is whether its place is known."""
        placed = deviations.get("where", np.inf) < KNOWN_PLACE * around.ranges["position"].span
        told = {name: d for name, d in deviations.items() if not (placed and name == "k")}
        return super().degenerate(around, values, told)

    def signals(self) -> tuple[str, ...]:
        return ("position",)


class AdditionalMode(Mechanism):
    """A further ``mass`` m on the body by a spring m ω² and a damper 2 ζ ω m."""

    name = "additional_mode"
    kinds = ("body",)
    needs = ("speed",)
    linear = True
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
