"""What is concealed in the machines that MuJoCo simulates: dry friction, damping, stops, filters, dead bands, tilt.

Switches are the changes to the description (`engine/describe.py`). `accept`, `near`, `ports` as in `arm.py`; twins, and why:

- A delay of the input is not one of a sensor where there are several sensors, or a law depends on the true position.
- A base tilted about a joint's axis is gravity, turned; on a pendulum the same as an angle sensor that is turned.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from experiments.concealed.effects import Effect, Pair, Surroundings, Switches
from experiments.concealed.laws.engine import OfTheEngine

DRY = ("coulomb_friction", "stribeck_friction")
Range = tuple[float, float]


def _effect(
    name: str,
    port: str,
    family: str,
    draw: Callable[[Generator, float, Surroundings], Switches],
    *,
    accept: tuple[Pair, ...],
    near: tuple[Pair, ...] = (),
    ports: tuple[str, ...] = (),
    alone: tuple[Pair, ...] = (),
    outside: bool = False,
) -> Effect:
    return Effect(
        name=name,
        law=OfTheEngine,
        port=port,
        family=family,
        draw=draw,
        accept=accept,
        near=near,
        ports=ports or tuple(dict.fromkeys(p for p, _ in (*accept, *alone))),
        alone=alone,
        outside=outside,
        sharp=not outside,
    )


def dry(joint: str, port: str, level: Range, *, behind: tuple[str, ...] = ()) -> Effect:
    """Dry friction of a joint. `behind`: ports of bodies that move nearly alike."""

    def draw(g: Generator, s: float, c: Surroundings) -> Switches:
        return {f"{joint}.frictionloss": s * g.uniform(*level)}

    near = ((port, "presliding_hysteresis"), *((other, name) for other in behind for name in DRY))
    return _effect(f"{port}_dry", port, "friction", draw, accept=tuple((port, n) for n in DRY), near=near)


def damping(joint: str, port: str, level: Range) -> Effect:
    """Damping of a joint of which the plain model has none."""

    def draw(g: Generator, s: float, c: Surroundings) -> Switches:
        return {f"{joint}.damping": s * g.uniform(*level)}

    return _effect(
        f"{port}_damping", port, "friction", draw,
        accept=((port, "viscous_friction"),), near=((port, "coulomb_friction"), (port, "quadratic_drag")),
    )  # fmt: skip


def stop(joint: str, port: str, travel: float) -> Effect:
    """A stop in the joint's way; the position of the first joint is what the draw goes by."""

    def draw(g: Generator, s: float, c: Surroundings) -> Switches:
        depth = min(s * g.uniform(0.04, 0.08), 0.5) * travel
        reached = np.sort(c.position[:, 0])[-1]  # in the experiment to choose with
        return {f"{joint}.upper": float(reached) - depth, f"{joint}.stop_time": g.uniform(0.01, 0.02)}

    return _effect(f"{port}_stop", port, "position", draw, accept=((port, "end_stop"),), near=((port, "unknown"),))


def drag(port: str, density: Range) -> Effect:
    """The air's drag, with the square of the speed."""

    def draw(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"density": s * g.uniform(*density)}

    return _effect(
        f"{port}_drag", port, "drag", draw, accept=((port, "quadratic_drag"),), near=((port, "viscous_friction"),)
    )


def drives(actuator: str, *, gain: bool, gain_twins: tuple[Pair, ...] = ()) -> list[Effect]:
    """Filter, delay and limit of the (first) motor, and its gain where inertia or weight are known.

    `gain_twins`: what is the same as a gain, once the equation is divided by it, where nothing else is concealed.
    """

    def lag(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"lag": min(s * g.uniform(0.003, 0.006), 0.05)}

    def delay(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"delay": min(s * g.uniform(0.002, 0.004), 0.03)}

    def limit(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"limit": c.peak * float(np.exp(-s * g.uniform(0.1, 0.2)))}

    def factor(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"gain": float(np.exp(min(s * g.uniform(0.04, 0.08), 0.4) * g.choice([-1.0, 1.0])))}

    late, slow = (actuator, "input_delay"), (actuator, "input_lag")
    found = [
        _effect("input_lag", actuator, "timing", lag, accept=(slow,), near=(late,)),
        _effect("input_delay", actuator, "timing", delay, accept=(late,), near=(slow,)),
        _effect("saturation", actuator, "actuator", limit, accept=((actuator, "torque_saturation"),)),
    ]
    right = ((actuator, "input_gain"),)
    gains = [_effect("input_gain", actuator, "gain", factor, accept=right, alone=gain_twins)] if gain else []
    return [*found, *gains]


def tilted(angle: Range, axis: int, accept: tuple[Pair, ...], near: tuple[Pair, ...]) -> Effect:
    """The base is tilted by an angle [rad], towards x (0) or y (1)."""

    def draw(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"tilt": min(s * g.uniform(*angle), 0.7) * float(g.choice([-1.0, 1.0])), "tilt_axis": float(axis)}

    return _effect("tilted_base", accept[0][0], "position", draw, accept=accept, near=near)


def dead_band(name: str, port: str, half_gap: Range) -> Effect:
    """A tendon that is slack within a band: backlash of a shaft."""

    def draw(g: Generator, s: float, c: Surroundings) -> Switches:
        return {f"{name}.gap": s * g.uniform(*half_gap)}

    return _effect(
        f"{port}_backlash", port, "gear", draw,
        accept=((port, "backlash"),), near=((port, "nonlinear_stiffness"), (port, "hysteretic_spring")),
    )  # fmt: skip


def slack_spring(joint: str, port: str, stiffness: Range, band: Range) -> Effect:
    """Outside the library: a spring to the base that is slack around the middle (a cable, a cover)."""

    def draw(g: Generator, s: float, c: Surroundings) -> Switches:
        return {f"{joint}.spring": s * g.uniform(*stiffness), f"{joint}.band": g.uniform(*band)}

    return _effect(
        f"{port}_slack_spring", port, "outside", draw,
        accept=((port, "unknown"),), near=((port, "end_stop"), (port, "gravity")), outside=True,
    )  # fmt: skip
