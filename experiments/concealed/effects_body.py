"""What is concealed in a machine with one body, in units of its own: force, speed and travel as they are usual there.

The columns `accept`, `near`, `ports` as in `effects.py`. Twins that hold for every such machine, and why:

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

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from experiments.concealed.effects import Draw, Effect, Pair, Surroundings, Switches
from experiments.concealed.laws import body, drive, dry


@dataclass(frozen=True)
class Usual:
    """What is usual in a machine: force, speed, half the travel; how far a bristle bends; the body's name."""

    body: str
    force: float
    speed: float
    travel: float
    bristle: float


def _sign(rng: Generator) -> float:
    return float(rng.choice([-1.0, 1.0]))


def _phase(rng: Generator) -> float:
    return float(rng.uniform(0.0, 2.0 * np.pi))


def frictions(u: Usual) -> list[Effect]:
    """Friction that is not in the plain model. Coulomb friction is set-valued: the body truly sticks."""

    def coulomb(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"level": s * u.force * g.uniform(0.05, 0.1)}

    def stribeck(g: Generator, s: float, c: Surroundings) -> Switches:
        level = s * u.force * g.uniform(0.04, 0.08)
        return {"level": level, "extra": level * g.uniform(0.6, 1.2), "v_s": u.speed * g.uniform(0.05, 0.15)}

    def warmup(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"change": s * u.force * g.uniform(0.08, 0.15), "T": g.uniform(0.8, 2.0)}

    def bristle(g: Generator, s: float, c: Surroundings) -> Switches:
        level, reach = s * u.force * g.uniform(0.05, 0.1), u.bristle * g.uniform(0.7, 1.4)
        return {"level": level, "stiffness": level / reach, "damping": 0.5 * level / u.speed}

    at = u.body
    dry_names = ("coulomb_friction", "stribeck_friction", "presliding_hysteresis")
    near = {name: tuple((at, other) for other in dry_names if other != name) for name in dry_names}
    return [
        Effect("coulomb", dry.DryCoulomb, at, "friction", coulomb,
               ((at, "coulomb_friction"), (at, "stribeck_friction")), ((at, "presliding_hysteresis"),), (at,)),
        Effect("stribeck", dry.DryStribeck, at, "friction", stribeck, ((at, "stribeck_friction"),),
               near["stribeck_friction"], (at,)),
        Effect("presliding", body.Bristle, at, "friction", bristle, ((at, "presliding_hysteresis"),),
               near["presliding_hysteresis"], (at,)),
        Effect("quadratic_drag", body.QuadraticDrag, at, "drag",
               lambda g, s, c: {"c": s * u.force / u.speed**2 * g.uniform(0.04, 0.08)}, ((at, "quadratic_drag"),), (), (at,)),
        Effect("warmup", dry.DryWarmup, at, "friction", warmup, ((at, "friction_warmup"),),
               ((at, "coulomb_friction"), (at, "stribeck_friction")), (at,)),
    ]  # fmt: skip


def richer(u: Usual) -> list[Effect]:
    """Laws richer than the library's: friction on an elastic seat, LuGre with a level that falls with speed, a stop that is hit."""
    at = u.body

    def seat(g: Generator, s: float, c: Surroundings) -> Switches:
        level, reach = s * u.force * g.uniform(0.05, 0.1), u.bristle * g.uniform(0.7, 1.4)
        return {"level": level, "stiffness": level / reach, "damping": 0.5 * level / u.speed}

    def lugre(g: Generator, s: float, c: Surroundings) -> Switches:
        level, reach = s * u.force * g.uniform(0.04, 0.08), u.bristle * g.uniform(0.7, 1.4)
        return {
            "level": level, "extra": level * g.uniform(0.6, 1.2), "v_s": u.speed * g.uniform(0.05, 0.15),
            "c": 0.2 * level / u.speed, "stiffness": level / reach, "damping": 0.5 * level / u.speed,
        }  # fmt: skip

    def hit(g: Generator, s: float, c: Surroundings) -> Switches:
        depth = min(s * g.uniform(0.05, 0.1), 0.5) * u.travel
        return {"limit": float(c.position.max()) - depth, "side": 1.0, "restitution": g.uniform(0.3, 0.7)}

    bristle, stribeck, plain = (
        (at, name) for name in ("presliding_hysteresis", "stribeck_friction", "coulomb_friction")
    )
    return [
        Effect(
            name="seat", law=dry.DryPresliding, port=at, family="friction", draw=seat,
            accept=(bristle,), near=(stribeck, plain), ports=(at,), sharp=True,
        ),
        Effect(
            name="lugre", law=body.StribeckBristle, port=at, family="friction", draw=lugre,
            accept=(bristle, stribeck), near=(plain,), ports=(at,), sharp=True,
        ),
        Effect(
            name="hard_end_stop", law=dry.HardStop, port=at, family="position", draw=hit,
            accept=((at, "end_stop"),), near=((at, "unknown"),), ports=(at,), sharp=True,
        ),
    ]  # fmt: skip


def forces(u: Usual) -> list[Effect]:
    """Forces that depend on position or on nothing, and one more mass."""
    at = u.body
    bias = ((at, "constant_bias"), ("actuator", "input_bias"))

    def pushed(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"bias": s * _sign(g) * u.force * g.uniform(0.02, 0.06)}

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
        Effect("constant_bias", body.ConstantBias, at, "bias", pushed, bias, (), (at, "actuator")),
        Effect("input_bias", drive.InputBias, "actuator", "bias", pushed, bias, (), (at, "actuator")),
        Effect("end_stop", body.EndStop, at, "position", end_stop, ((at, "end_stop"),), (), (at,)),
        Effect("mode", body.AdditionalMode, at, "mode", mode, ((at, "additional_mode"),), (), (at,)),
    ]


def ripple(u: Usual, lowest: float, highest: float) -> Effect:
    """A force periodic in position, with `lowest` to `highest` periods a turn (radians a metre on a rail)."""

    def draw(g: Generator, s: float, c: Surroundings) -> Switches:
        order = float(np.exp(g.uniform(np.log(lowest), np.log(highest))))
        if lowest < 100.0:
            order = float(np.round(order))  # whole periods a turn; a leadscrew's pitch is what it is
        return {"amplitude": s * u.force * g.uniform(0.05, 0.1), "order": order, "phase": _phase(g)}

    at = u.body
    return Effect("ripple", body.TorqueRipple, at, "position", draw, ((at, "torque_ripple"), ("actuator", "torque_ripple")),
                  ((at, "position_dependent_friction"),), (at, "actuator"))  # fmt: skip


def drives(u: Usual) -> list[Effect]:
    """Static maps from the recorded force to the one that acts, that nothing else looks like."""

    def saturation(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"limit": c.peak * float(np.exp(-s * g.uniform(0.1, 0.2)))}

    return [
        Effect("saturation", drive.TorqueSaturation, "actuator", "actuator", saturation,
               (("actuator", "torque_saturation"),), (), ("actuator",)),
        Effect("deadzone", drive.ActuatorDeadzone, "actuator", "actuator",
               lambda g, s, c: {"half_width": s * u.force * g.uniform(0.04, 0.08)}, (("actuator", "actuator_deadzone"),), (),
               ("actuator",)),
    ]  # fmt: skip


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
        return Effect(name, law, port, "timing", draw, own, near, places, alone=twins)

    return [
        entry("input_delay", drive.InputDelay, "actuator", delay, delays[0], False),
        entry("output_delay", drive.OutputDelay, sensor, delay, delays[1], False),
        entry("input_lag", drive.InputLag, "actuator", lag, lags[0], True),
        entry("sensor_lag", drive.SensorLag, sensor, lag, lags[1], True),
    ]


def gains(sensor: str, accepted: tuple[tuple[Pair, ...], tuple[Pair, ...]]) -> list[Effect]:
    """A gain of the input and of one sensor that is not what the data sheet says."""

    def gain(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"gain": float(np.exp(min(s * g.uniform(0.04, 0.08), 0.4) * _sign(g)))}

    def entry(name: str, law: type, port: str, accept: tuple[Pair, ...]) -> Effect:
        return Effect(name, law, port, "gain", gain, accept, (), tuple(dict.fromkeys(p for p, _ in accept)))

    return [
        entry("input_gain", drive.InputGain, "actuator", accepted[0]),
        entry("sensor_gain", drive.SensorGain, sensor, accepted[1]),
    ]


def outside(u: Usual) -> list[Effect]:
    """Physics that no mechanism of the library describes: the right answer is `unknown`, at the right place."""
    at = u.body

    def bump(g: Generator, s: float, c: Surroundings) -> Switches:
        center = u.speed * g.uniform(0.35, 0.6)
        return {
            "height": s * u.force * g.uniform(0.08, 0.15), "center": center, "width": 0.2 * center, "v_0": 0.05 * u.speed,
        }  # fmt: skip

    def notch(g: Generator, s: float, c: Surroundings) -> Switches:
        return {
            "height": s * u.force * g.uniform(0.1, 0.2), "center": u.travel * g.uniform(-0.4, 0.4),
            "width": u.travel * g.uniform(0.06, 0.1),
        }  # fmt: skip

    def waves(g: Generator, s: float, c: Surroundings) -> Switches:
        return {
            "height": s * u.force * g.uniform(0.08, 0.15), "spacing": u.speed * g.uniform(0.05, 0.09), "v_0": 0.05 * u.speed,
        }  # fmt: skip

    def fade(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"loss": min(s * g.uniform(0.1, 0.2), 0.9), "top": u.speed}

    unknown = ((at, "unknown"),)
    return [
        Effect("speed_bump", body.SpeedBump, at, "outside", bump, unknown, (), (at,), outside=True),
        Effect("notch", body.Notch, at, "outside", notch, unknown, (), (at,), outside=True),
        Effect("speed_waves", body.SpeedWaves, at, "outside", waves, unknown, (), (at,), outside=True),
        Effect("torque_fade", drive.TorqueFade, "actuator", "outside", fade, (("actuator", "unknown"), *unknown),
               (("actuator", "input_gain"),), ("actuator", at), outside=True),
    ]  # fmt: skip
