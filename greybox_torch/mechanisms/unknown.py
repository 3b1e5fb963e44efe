"""A flexible curve over one signal: the ceiling that named mechanisms are measured against, and the answer `unknown`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch

from greybox_torch.in_unit import in_unit
from greybox_torch.mechanisms.mechanism import Mechanism, Probe, Surroundings
from greybox_torch.model import Parameter, Signals
from greybox_torch.model.own_rate import RATE
from greybox_torch.model.signals_elsewhere import DIFFERENCE, POSITION, SPEED
from greybox_torch.model.within_turn import TURN, TURN_OF, WHOLE

REACH = 4
"""To either side of how many neighbours a bump is computed with: an exponential costs as much as ten products."""

FAR = 10.5
"""Spacings from a bump beyond which it and its neighbours are below 1e-18; exp(2 · 10.5)⁴ is still a number in single precision."""


INPUT = "input@"
"""Beginning of the name of a signal that is an input of the model."""


class Unknown(Mechanism):
    """A sum of smooth bumps over the range of one signal.

    ``knots`` bumps exp(−((s − s_k) / w)²) with centres spread evenly over where the signal moved; beyond that the curve stays level. Over
    a ``part`` (low, high) of that the centres are spread from one end of the part to the other, and beyond it the curve is zero.
    With a ``factor`` the curve is what that other signal is multiplied by: a gain that changes. The factor may be an input of the model,
    ``input@NAME``, also where it does not act; the signal may be that of another port, ``position@BODY`` or ``level@BALANCE``: what one
    axis does to the other, a charge to how a battery warms, or the angle of its rotor (``turn@BODY``) to what a pump delivers. Of a
    ``difference@BALANCE`` of levels it is what two balances exchange: the other one has it with the opposite sign.

    The factor ``rate@PORT`` is how fast the port's own level or speed changes without this curve: a capacity or an inertia that varies. An
    inertia m(θ) more than the model has needs −m a − ½ m' ω² of the torque; one over the position of another axis, m(θ_2), needs
    −m a − m' ω_2 ω, and pushes that axis with ½ m' ω². Bumps that are ``left_out`` are zero.
    """

    name = "unknown"
    kinds = ("body", "coupling", "balance", "actuator", "sensor")
    free = True
    explanation = "Something repeatable is missing here that no known mechanism describes; the curve shows what."
    source = "radial basis functions: D. S. Broomhead, D. Lowe, Complex Systems 2, 1988"

    def __init__(
        self,
        signal: str,
        knots: int = 14,
        factor: str = "",
        left_out: Sequence[int] = (),
        part: Sequence[float] | None = None,
    ) -> None:
        self.signal = signal
        self.knots = knots
        self.factor = factor
        self.left_out = tuple(left_out)
        self.part = None if part is None else (float(part[0]), float(part[1]))
        self.by_rate = factor.startswith(RATE)
        at_other = self.by_rate and signal.startswith(POSITION)
        self.other_axis = signal.removeprefix(POSITION) if at_other else ""
        speed = (f"{SPEED}{self.other_axis}",) if at_other else ()
        self.reads = (*(one for one in (signal, factor) if "@" in one), *speed)

    @property
    def bumps(self) -> list[int]:
        """The numbers of the bumps that it consists of."""
        return [k for k in range(self.knots) if k not in self.left_out]

    def parameters(self, around: Surroundings) -> list[Parameter]:
        centres = self.centres(around)
        unit, over = around.units.get(self.signal, ""), self.signal.removeprefix(INPUT)
        heights = [
            Parameter(
                f"w_{k}",
                0.0,
                self.force_unit(around),
                description=f"height at {over} = {in_unit(f'{centres[k]:g}', unit)}",
                shrunk=True,
            )
            for k in self.bumps
        ]
        first = Parameter("first", centres[0], unit, fixed=True, description=f"first centre over {over}")
        spacing = Parameter(
            "spacing", centres[1] - centres[0], unit, fixed=True, description=f"distance of the centres over {over}"
        )
        return [*heights, first, spacing]

    def force_unit(self, around: Surroundings) -> str:
        """The unit of the heights: of the force at the port, or of what turns the factor into it."""
        if not self.factor:
            return around.force_unit
        return "" if self.factor == "input" else around.per(self.factor)

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        curve = self.curve(s, p)
        if self.factor not in s:
            return curve
        force = curve * s[self.factor]
        if self.by_rate and self.signal in ("position", TURN):
            return force + 0.5 * self.slope(s, p) * s.speed**2
        return force + self.slope(s, p) * s[f"{SPEED}{self.other_axis}"] * s.speed if self.other_axis else force

    def elsewhere(self, s: Signals, p: Signals, z: Signals) -> dict[str, Any]:
        if self.other_axis:
            return {self.other_axis: -0.5 * self.slope(s, p) * s.speed**2}
        taken = next((n.removeprefix(DIFFERENCE) for n in self.reads if n.startswith(DIFFERENCE)), None)
        return {} if taken is None else {taken: -self.force(s, p, z)}

    def curve(self, s: Signals, p: Signals) -> Any:
        """The sum of the bumps at the signal."""
        return self._sum_of_bumps(s, p, self._heights(p))

    def slope(self, s: Signals, p: Signals) -> Any:
        """How steep the curve is at the signal: zero where it stays level."""
        heights = self._heights(p)
        moment = self._sum_of_bumps(s, p, {k: k * height for k, height in heights.items()})
        steep = 2.0 / p.spacing * (moment - self._place(s, p) * self._sum_of_bumps(s, p, heights))
        there = (s[self.signal] - p.first) / p.spacing
        return torch.where((there > 1.0) & (there < self.knots - 2.0), steep, 0.0) if self.level_beyond else steep

    @property
    def closed(self) -> bool:
        """Whether the curve ends where it begins: over a turn."""
        return self.signal == TURN or self.signal.startswith(TURN_OF)

    @property
    def level_beyond(self) -> bool:
        """Whether the curve stays level beyond its range: one over a turn has no end, one over a part is zero there."""
        return not (self.closed or self.part)

    def altered(self, **options: Any) -> Unknown:
        """The same curve but for some of its options."""
        return Unknown(**{**self.options(), **options})

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe(tuple(f"w_{k}" for k in self.bumps))]

    @property
    def only_coarse(self) -> bool:
        """Whether a finer curve would say nothing: time does not come back, so that it would only draw what happened once."""
        return self.signal == "time"

    def available(self, around: Surroundings) -> bool:
        return set(self.signals()) <= set(around.ranges) and self.signal not in around.passed_once

    def signals(self) -> tuple[str, ...]:
        return (self.signal, self.factor) if self.factor else (self.signal,)

    def centres(self, around: Surroundings) -> list[float]:
        """Centres of the bumps, in the signal's unit; one lies beyond either end of the range, so that the ends are covered as well, but
        over a turn or a part.
        """
        if self.closed:
            return [WHOLE / self.knots * k for k in range(self.knots)]
        if self.part:
            return [float(centre) for centre in np.linspace(*self.part, self.knots)]
        reached = around.ranges[self.signal]
        spacing = reached.span / (self.knots - 3)
        return [reached.low + spacing * (k - 1) for k in range(self.knots)]

    def grid(self, around: Surroundings, points: int) -> torch.Tensor:
        """So many values of the signal over its range; over a part of that as many more, in their order, since it may be narrow."""
        span = around.ranges[self.signal]
        whole = torch.linspace(span.low, span.high, points, dtype=torch.float64)
        if not self.part:
            return whole
        return torch.cat([whole, torch.linspace(*self.part, points, dtype=torch.float64)]).sort().values

    def _heights(self, p: Signals) -> dict[int, Any]:
        """The heights of the bumps by number; over a turn of those before and after it as well."""
        numbers = range(-REACH, self.knots + REACH) if self.closed else range(self.knots)
        return {k: p[f"w_{k % self.knots}"] for k in numbers if k % self.knots not in self.left_out}

    def _place(self, s: Signals, p: Signals) -> Any:
        """Where the signal is, in spacings from the first centre."""
        place = (s[self.signal] - p.first) / p.spacing
        return torch.clamp(place, 1.0, self.knots - 2.0) if self.level_beyond else place

    def _sum_of_bumps(self, s: Signals, p: Signals, heights: Mapping[int, Any]) -> Any:
        place, beside = self._place(s, p), REACH if self.closed else 0
        centres = range(REACH - beside, self.knots + REACH + beside, 2 * REACH + 1)
        return sum(_bumps_around(place, centre, heights) for centre in centres)


def _bumps_around(place: Any, centre: int, heights: Mapping[int, Any]) -> Any:
    """The sum of the bumps numbered ``centre`` and its neighbours: exp(−(d − j)²) = exp(−d²) exp(2 d)^j exp(−j²), d from the centre."""
    near = [k for k in heights if abs(k - centre) <= REACH]
    if not near:
        return 0.0
    away = torch.clamp(place - centre, -FAR, FAR)
    middle, total = torch.exp(-(away**2)), 0.0
    if centre in heights:
        total = heights[centre] * middle
    for side in (1, -1):
        reach = max((side * (k - centre) for k in near), default=0)
        if reach <= 0:
            continue
        bump, ratio = middle, torch.exp(2.0 * side * away)
        for j in range(1, reach + 1):
            bump = bump * ratio
            if centre + side * j in heights:
                total = total + heights[centre + side * j] * math.exp(-(j**2)) * bump
    return total
