"""Stops at the ends of a body's travel."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch

from greybox_torch.mechanisms.degenerate import beyond
from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Range, Surroundings
from greybox_torch.model import Parameter, Signals

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

FARTHEST_IN = (0.03, 0.1, 0.25)
"""Shares of the travel from its end where the screen looks for a stop."""

AT_AN_END = 0.1
"""Share of the travel from its end within which a curve has to push back, by a third of its largest force, for a stop to be there."""


class EndStop(Mechanism):
    """−k (θ − θ_1) − c ω beyond θ_1 (``side`` +1) or below it (``side`` −1), as long as that pushes back: a stop does not pull.

    With stops at ``both`` ends, beyond ``high`` and below ``low``, alike in k and c.
    """

    name = "end_stop"
    kinds = ("body",)
    needs = ("position", "speed")
    at_rest = ("speed",)
    nature = "a force that depends on position"
    explanation = "Past a position something stiff pushes back (mechanical stop, cable)."
    source = "F. Pfeiffer, C. Glocker, Multibody Dynamics with Unilateral Contacts, 1996"
    experiment = "slow approach to the ends of travel"

    def __init__(self, both: bool = False) -> None:
        self.both = both
        if both:
            self.generalises = (self.name,)

    def described_here(self) -> str:
        return "−k (θ − high) − c ω above high, −k (θ − low) − c ω below low" if self.both else self.described()

    def parameters(self, around: Surroundings) -> list[Parameter]:
        travel = around.ranges["position"]
        low, high, margin = travel.low, travel.low + travel.span, MARGIN * travel.span
        place = {"unit": around.units.get("position", ""), "lower": low - margin, "upper": high + margin}
        stiffness = Parameter("k", 0.0, around.per("position"), lower=0.0, description="stiffness of the stop")
        damping = Parameter("c", 0.0, around.per("speed"), lower=0.0, description="damping of the stop")
        if self.both:
            ends = [("low", low, "lower stop"), ("high", high, "upper stop")]
            return [stiffness, *(Parameter(n, at, description=d, **place) for n, at, d in ends), damping]
        told = "+1: the stop is above, -1: below"
        one = Parameter("where", high, description="stop", **place)
        return [stiffness, one, damping, Parameter("side", 1.0, "", fixed=True, description=told)]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        if not self.both:
            return -p.side * _pushed_back(p.side * (s.position - p.where), p.side * s.speed, p)
        above = _pushed_back(s.position - p.high, s.speed, p)
        return _pushed_back(p.low - s.position, -s.speed, p) - above

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        travel = around.ranges["position"]
        ends = [(travel.low + share * travel.span, travel.high - share * travel.span) for share in FARTHEST_IN]
        if self.both:
            return [Probe(("k",), {"low": low, "high": high, "c": 0.0}) for low, high in ends]
        above = [Probe(("k",), {"where": high, "side": 1.0, "c": 0.0}) for _, high in ends]
        return above + [Probe(("k",), {"where": low, "side": -1.0, "c": 0.0}) for low, _ in ends]

    def misplaced(self, around: Surroundings, values: Mapping[str, float]) -> str | None:
        travel = around.ranges["position"]
        margin, said = MARGIN * travel.span, None
        for name, where in self._places(values).items():
            if not travel.low - margin < where < travel.high + margin:
                return beyond(name, where, around, "position")
            above = name == "high" or (name == "where" and values["side"] > 0)
            said = said or _gives_way(travel.high - where if above else where - travel.low, travel, around)
        return said

    def degenerate(
        self, around: Surroundings, values: Mapping[str, float], deviations: Mapping[str, float]
    ) -> str | None:
        """Of a rigid stop no recording tells how stiff it is, only that it is stiff: what counts is whether its place is known."""
        most = KNOWN_PLACE * around.ranges["position"].span
        unknown = [name for name in self._places(values) if not deviations.get(name, np.inf) < most]
        told = {name: d for name, d in deviations.items() if unknown or name != "k"}
        if self.both and unknown and deviations:
            return f"where the {'lower' if unknown[0] == 'low' else 'upper'} stop stands is not known: one of the two may not be there"
        return super().degenerate(around, values, told)

    def nearest(
        self, around: Surroundings, signals: Mapping[str, torch.Tensor], force: np.ndarray, weight: np.ndarray
    ) -> Mechanism:
        """At both ends where the force pushes back at either."""
        position, travel = signals["position"].numpy(), around.ranges["position"]
        least = np.max(np.abs(force), initial=0.0) / 3.0
        below = (position < travel.low + AT_AN_END * travel.span) & (weight > 0.0)
        above = (position > travel.high - AT_AN_END * travel.span) & (weight > 0.0)
        pushes = below.any() and above.any() and force[below].max() > least and force[above].min() < -least
        return type(self)(bool(pushes))

    def begun_elsewhere(self, around: Surroundings, values: Mapping[str, float]) -> Sequence[Mapping[str, float]]:
        travel, (stiff, hard) = around.ranges["position"], STIFFER
        ends = {"low": travel.low, "high": travel.high}
        if not self.both:
            ends = {"where": travel.high if values["side"] > 0 else travel.low}
        return [{"k": stiff * values["k"]}, {"k": hard * values["k"], **ends}]

    def acts_beyond(self, values: Mapping[str, float]) -> tuple[float | None, float | None] | None:
        if self.both:
            return values["low"], values["high"]
        return (None, values["where"]) if values["side"] > 0 else (values["where"], None)

    def contained_as(self, values: Mapping[str, float]) -> Sequence[Mapping[str, float]]:
        alike = {"k": values["k"], "c": values["c"]}
        ends = [("low", -1.0), ("high", 1.0)] if self.both else []
        return [{**alike, "where": values[end], "side": side} for end, side in ends]

    def signals(self) -> tuple[str, ...]:
        return ("position",)

    def _places(self, values: Mapping[str, float]) -> dict[str, float]:
        return {name: values[name] for name in (("low", "high") if self.both else ("where",))}


def _pushed_back(beyond: Any, outward: Any, p: Signals) -> Any:
    """What a stop pushes with, as far as the body is ``beyond`` it and moves ``outward``."""
    back = p.k * beyond + p.c * outward
    return torch.where((beyond > 0.0) & (back >= 0.0), back, 0.0)


def _gives_way(passed: float, travel: Range, around: Surroundings) -> str | None:
    """What is wrong with a stop beyond which so much of the travel lies."""
    share, unseen = passed / travel.span, "position" in around.unmeasured
    if share <= (GIVES_WAY_UNSEEN if unseen else GIVES_WAY):
        return None
    return f"{100 * share:.0f} % of the travel lies beyond it: no stop gives way so far"
