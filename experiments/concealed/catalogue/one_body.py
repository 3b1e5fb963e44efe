"""What is concealed in a machine with one body, in units of its own: force, speed and travel as they are usual there.

The columns `accept`, `near`, `ports` as in `arm.py`. Twins that hold for every such machine, and why:

- A constant force on the body is the same as one at the actuator, and so is a ripple: nothing lies between the two.
- A machine with no law that depends on time, position or speed (the stage: linear but for what is concealed) cannot tell a delay, a
  lag or a gain of the input from one of its only output: they commute. Delays and gains still do beside another effect (its own
  parameters take up the gain), a lag beside something that is not linear does not: `alone`. The pendulum can tell them apart: gravity
  depends on the true angle, and with two sensors a delay of one is not a delay of the other.

Left out: Coulomb asymmetry, friction that varies with position, and viscous friction, as they add to a friction that these plain models
do not have, or that is a parameter of theirs; they are concealed in the arm. A bias of a position sensor: it shifts the origin of the
stage, and on the pendulum it turns gravity by an angle, which is gravity's own name.
"""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from experiments.concealed.catalogue.one_body_friction import Usual
from experiments.concealed.effects import Draw, Effect, Pair, Surroundings, Switches, phase, sign
from experiments.concealed.laws import body, drive


def forces(u: Usual) -> list[Effect]:
    """Forces that depend on position or on nothing, and one more mass."""
    at = u.body
    bias = ((at, "constant_bias"), ("actuator", "input_bias"))

    def pushed(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"bias": s * sign(g) * u.force * g.uniform(0.02, 0.06)}

    def end_stop(g: Generator, s: float, c: Surroundings) -> Switches:
        depth = min(s * g.uniform(0.05, 0.1), 0.5) * u.travel
        return {
            "limit": float(c.position.max()) - depth, "side": 1.0, "stiffness": 40.0 * u.force / u.travel,
            "damping": 0.5 * u.force / u.speed,
        }  # fmt: skip

    def mode(g: Generator, s: float, c: Surroundings) -> Switches:
        return {
            "inertia": s * c.truth["inertia"] * g.uniform(0.04, 0.08), "frequency": g.uniform(4.0, 9.0),
            "damping_ratio": g.uniform(0.02, 0.08),
        }  # fmt: skip

    return [
        Effect(
            name="constant_bias",
            law=body.ConstantBias,
            port=at,
            family="bias",
            draw=pushed,
            accept=bias,
            ports=(at, "actuator"),
        ),
        Effect(
            name="input_bias",
            law=drive.InputBias,
            port="actuator",
            family="bias",
            draw=pushed,
            accept=bias,
            ports=(at, "actuator"),
        ),
        Effect(
            name="end_stop",
            law=body.EndStop,
            port=at,
            family="position",
            draw=end_stop,
            accept=((at, "end_stop"),),
            ports=(at,),
        ),
        Effect(
            name="mode",
            law=body.AdditionalMode,
            port=at,
            family="mode",
            draw=mode,
            accept=((at, "additional_mode"),),
            ports=(at,),
        ),
    ]


def ripple(u: Usual, lowest: float, highest: float) -> Effect:
    """A force periodic in position, with `lowest` to `highest` periods a turn (radians a metre on a rail)."""

    def draw(g: Generator, s: float, c: Surroundings) -> Switches:
        order = float(np.exp(g.uniform(np.log(lowest), np.log(highest))))
        if lowest < 100.0:
            order = float(np.round(order))  # whole periods a turn; a leadscrew's pitch is what it is
        return {"amplitude": s * u.force * g.uniform(0.05, 0.1), "order": order, "phase": phase(g)}

    at = u.body
    return Effect(
        name="ripple",
        law=body.TorqueRipple,
        port=at,
        family="position",
        draw=draw,
        accept=((at, "torque_ripple"), ("actuator", "torque_ripple")),
        near=((at, "position_dependent_friction"),),
        ports=(at, "actuator"),
    )


def drives(u: Usual) -> list[Effect]:
    """Static maps from the recorded force to the one that acts, that nothing else looks like."""

    def saturation(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"limit": c.peak * float(np.exp(-s * g.uniform(0.1, 0.2)))}

    return [
        Effect(
            name="saturation",
            law=drive.TorqueSaturation,
            port="actuator",
            family="actuator",
            draw=saturation,
            accept=(("actuator", "torque_saturation"),),
            ports=("actuator",),
        ),
        Effect(
            name="deadzone",
            law=drive.ActuatorDeadzone,
            port="actuator",
            family="actuator",
            draw=lambda g, s, c: {"half_width": s * u.force * g.uniform(0.04, 0.08)},
            accept=(("actuator", "actuator_deadzone"),),
            ports=("actuator",),
        ),
    ]


def timings(
    sensor: str,
    longest: float,
    delays: tuple[tuple[Pair, ...], tuple[Pair, ...]],
    lags: tuple[tuple[Pair, ...], tuple[Pair, ...]],
) -> list[Effect]:
    """Delay and lag of the input and of one sensor, `longest` at most [s]; `delays` and `lags`: the answers that are right for either."""

    def delay(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"delay": min(s * g.uniform(0.002, 0.004), longest)}

    def lag(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"T": min(s * g.uniform(0.002, 0.004), longest)}

    every = (("actuator", "input_delay"), ("actuator", "input_lag"), (sensor, "output_delay"), (sensor, "sensor_lag"))

    def entry(name: str, law: type, port: str, draw: Draw, right: tuple[Pair, ...], alone: bool) -> Effect:
        """`alone`: twins at another port are right only where nothing else is concealed."""
        own = tuple(pair for pair in right if pair[0] == port or not alone)
        twins = tuple(pair for pair in right if pair not in own)
        near = tuple(pair for pair in every if pair not in right)
        places = tuple(dict.fromkeys(p for p, _ in right))
        return Effect(
            name=name, law=law, port=port, family="timing", draw=draw, accept=own, near=near, ports=places, alone=twins
        )

    return [
        entry("input_delay", drive.InputDelay, "actuator", delay, delays[0], False),
        entry("output_delay", drive.OutputDelay, sensor, delay, delays[1], False),
        entry("input_lag", drive.InputLag, "actuator", lag, lags[0], True),
        entry("sensor_lag", drive.SensorLag, sensor, lag, lags[1], True),
    ]


def gains(
    sensor: str, accepted: tuple[tuple[Pair, ...], tuple[Pair, ...]], input_twins: tuple[Pair, ...] = ()
) -> list[Effect]:
    """A gain of the input and of one sensor that is not what the data sheet says.

    `input_twins`: what is the same as the input's, once the equation is divided by it, where nothing else is concealed.
    """

    def gain(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"gain": float(np.exp(min(s * g.uniform(0.04, 0.08), 0.4) * sign(g)))}

    def entry(name: str, law: type, port: str, accept: tuple[Pair, ...], twins: tuple[Pair, ...] = ()) -> Effect:
        return Effect(
            name=name,
            law=law,
            port=port,
            family="gain",
            draw=gain,
            accept=accept,
            ports=tuple(dict.fromkeys(p for p, _ in (*accept, *twins))),
            alone=twins,
        )

    return [
        entry("input_gain", drive.InputGain, "actuator", accepted[0], input_twins),
        entry("sensor_gain", drive.SensorGain, sensor, accepted[1]),
    ]
