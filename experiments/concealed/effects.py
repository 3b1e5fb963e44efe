"""The catalogue of concealed effects: which law, how strong, and which answers are right, near, or at the right place.

`accept` lists the (port, mechanism) pairs that name the effect, its twins on such data included; `near` those that a
reasonable engineer could defend; `ports` the places that count as located. Twins, and why:

- A constant torque is the same at the motor, at the actuator and, but for a constant twist, at gearbox and arm.
- A delay of the input and one of the output differ by a shift of time only, and the plant does not depend on time.
- Gravity turns once in a turn of any of the three bodies, which differ by a small twist.

Left out, because torque and motor speed alone cannot show them: `input_gain` and `sensor_gain` (J is fixed, yet a gain
that scales torque, or speed, is taken up by friction, stiffness and the other constants only in part; which of the two it was,
and whether it was not J that is wrong, nothing tells), Coulomb, viscous and Stribeck friction at the motor (parameters of the
plain model), and nonlinear stiffness of the gear spring (likewise, `k_g3`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from experiments.concealed.laws import Law, body, coupling, drive, dry

Pair = tuple[str, str]
Switches = dict[str, float]
STRENGTHS = {"weak": 0.35, "moderate": 1.0, "dominant": 2.5}


@dataclass(frozen=True)
class Surroundings:
    """What a draw may depend on: the true parameters, and the positions (samples, 4) and the largest torque of the first experiment,
    as the machine passes them without effect."""

    truth: Mapping[str, float]
    position: NDArray[np.float64]
    peak: float = np.nan


Draw = Callable[[Generator, float, Surroundings], Switches]


@dataclass(frozen=True)
class Effect:
    """One entry of the catalogue. `family`: effects of one family are not concealed together."""

    name: str
    law: type[Law]
    port: str
    family: str
    draw: Draw
    accept: tuple[Pair, ...]
    near: tuple[Pair, ...] = ()
    ports: tuple[str, ...] = ()
    outside: bool = False
    alone: tuple[Pair, ...] = ()
    """Further answers that are right as long as nothing else is concealed, and near otherwise."""
    sharp: bool = False
    """Physics with an edge, or richer than the library's law, in place of the law that the standard set has; for the proof alone."""


def _sign(rng: Generator) -> float:
    return float(rng.choice([-1.0, 1.0]))


def _phase(rng: Generator) -> float:
    return float(rng.uniform(0.0, 2.0 * np.pi))


def _between(position: NDArray[np.float64], share: float) -> float:
    low, high = float(position.min()), float(position.max())
    return low + share * (high - low)


BIAS: tuple[Pair, ...] = (
    ("motor", "constant_bias"),
    ("actuator", "input_bias"),
    ("gearbox", "constant_bias"),
    ("arm", "constant_bias"),
)
DELAY: tuple[Pair, ...] = (("actuator", "input_delay"), ("sensor", "output_delay"))
LAG: tuple[Pair, ...] = (("actuator", "input_lag"), ("sensor", "sensor_lag"))
BODIES = ("motor", "gearbox", "arm")
DRY_NAMES = ("coulomb_friction", "stribeck_friction", "presliding_hysteresis")


def _friction_effects() -> list[Effect]:
    def at(name: str, *bodies: str) -> tuple[Pair, ...]:
        return tuple((b, name) for b in bodies)

    def coulomb(low: float, high: float) -> Draw:
        return lambda g, s, c: {"level": s * g.uniform(low, high), "v_0": 0.2}

    def stribeck(g: Generator, s: float, c: Surroundings) -> Switches:
        return {
            "level": s * g.uniform(0.12, 0.2), "extra": s * g.uniform(0.3, 0.45), "v_s": g.uniform(3.0, 6.0),
            "c": s * g.uniform(0.001, 0.003), "v_0": 0.3,
        }  # fmt: skip

    def warmup(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"change": s * g.uniform(0.15, 0.3), "T": g.uniform(1.5, 4.0), "grows": float(g.integers(2)), "v_0": 0.3}

    def bristle(g: Generator, s: float, c: Surroundings) -> Switches:
        level, reach = s * g.uniform(0.25, 0.4), g.uniform(0.03, 0.08)  # slides after `reach` radians
        return {"level": level, "stiffness": level / reach, "damping": 0.02 * level}

    return [
        Effect("arm_viscous", body.Viscous, "arm", "viscous", lambda g, s, c: {"c": s * g.uniform(0.01, 0.02)},
               at("viscous_friction", "arm"), at("viscous_friction", "gearbox"), ("arm", "gearbox")),
        Effect("gearbox_viscous", body.Viscous, "gearbox", "viscous", lambda g, s, c: {"c": s * g.uniform(0.015, 0.03)},
               at("viscous_friction", "gearbox"), at("viscous_friction", "arm"), ("gearbox", "arm")),
        Effect("arm_coulomb", body.Coulomb, "arm", "friction", coulomb(0.25, 0.45),
               at("coulomb_friction", "arm") + at("stribeck_friction", "arm"),
               at("coulomb_friction", "gearbox") + at("stribeck_friction", "gearbox"), ("arm", "gearbox")),
        Effect("gearbox_coulomb", body.Coulomb, "gearbox", "friction", coulomb(0.3, 0.5),
               at("coulomb_friction", "gearbox") + at("stribeck_friction", "gearbox"),
               at("coulomb_friction", "arm") + at("stribeck_friction", "arm"), ("gearbox", "arm")),
        Effect("arm_stribeck", body.Stribeck, "arm", "friction", stribeck, at("stribeck_friction", "arm"),
               at("coulomb_friction", "arm", "gearbox") + at("stribeck_friction", "gearbox"), ("arm", "gearbox")),
        Effect("asymmetry", body.CoulombAsymmetry, "motor", "bias",
               lambda g, s, c: {"difference": min(s * g.uniform(0.07, 0.15), 0.9) * c.truth["F_c"],
                                "v_0": 1.0 / c.truth["beta"]},
               at("coulomb_asymmetry", "motor"), BIAS, ("motor", "actuator")),
        Effect("quadratic_drag", body.QuadraticDrag, "motor", "drag", lambda g, s, c: {"c": s * g.uniform(0.0008, 0.0016)},
               at("quadratic_drag", "motor"), at("quadratic_drag", "gearbox", "arm"), BODIES),
        Effect("load_friction", body.LoadDependentFriction, "motor", "load",
               lambda g, s, c: {"c": min(s * g.uniform(0.1, 0.18), 0.8), "v_0": 1.0 / c.truth["beta"]},
               at("load_dependent_friction", "motor", "gearbox"), (), ("motor", "gearbox")),
        Effect("position_friction", body.PositionDependentFriction, "motor", "position",
               lambda g, s, c: {"level": s * g.uniform(0.15, 0.3), "order": float(g.integers(1, 5)),
                                "phase": _phase(g), "v_0": 0.5},
               at("position_dependent_friction", "motor"),
               at("position_dependent_friction", "gearbox") + at("torque_ripple", "motor"), ("motor", "gearbox")),
        Effect("warmup", body.FrictionWarmup, "motor", "time", warmup, at("friction_warmup", "motor"),
               at("friction_warmup", "gearbox", "arm"), ("motor", "gearbox")),
        Effect("presliding", body.Bristle, "motor", "bristle", bristle, at("presliding_hysteresis", "motor"),
               at("presliding_hysteresis", "gearbox") + at("coulomb_friction", "motor") + at("stribeck_friction", "motor"),
               ("motor", "gearbox")),
    ]  # fmt: skip


def _force_effects() -> list[Effect]:
    def ripple(g: Generator, s: float, c: Surroundings) -> Switches:
        order = float(np.round(np.exp(g.uniform(np.log(2.0), np.log(40.0)))))
        amplitude = s * g.uniform(0.2, 0.35) * max(1.0, order / 12.0)  # inertia hides the fast ones
        return {"amplitude": amplitude, "order": order, "phase": _phase(g)}

    def end_stop(g: Generator, s: float, c: Surroundings) -> Switches:
        limit = float(c.position[:, 0].max()) - g.uniform(0.5, 1.2)
        return {"limit": limit, "side": 1.0, "stiffness": s * g.uniform(2.0, 5.0), "damping": 0.02}

    def mode(port: str) -> Draw:
        def draw(g: Generator, s: float, c: Surroundings) -> Switches:
            t = c.truth
            own = t["J"] * (t["a_m"] if port == "motor" else 1.0 - t["a_m"] - t["a_g"])
            return {
                "inertia": s * own * g.uniform(0.1, 0.25), "frequency": g.uniform(9.0, 28.0),
                "damping_ratio": g.uniform(0.02, 0.08),
            }  # fmt: skip

        return draw

    def gravity(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"moment": s * g.uniform(0.3, 0.7), "angle": _phase(g)}

    return [
        Effect("constant_bias", body.ConstantBias, "motor", "bias",
               lambda g, s, c: {"bias": s * _sign(g) * g.uniform(0.03, 0.1)},
               BIAS, (("motor", "coulomb_asymmetry"),), ("motor", "gearbox", "arm", "actuator")),
        Effect("gravity", body.Gravity, "arm", "position", gravity,
               tuple((b, "gravity") for b in ("arm", "gearbox", "motor")), (("motor", "torque_ripple"),), BODIES),
        Effect("ripple", body.TorqueRipple, "motor", "position", ripple,
               (("motor", "torque_ripple"), ("actuator", "torque_ripple")),
               (("motor", "position_dependent_friction"), ("gearbox", "torque_ripple"),
                ("gear_spring", "transmission_error")), ("motor", "actuator")),
        Effect("end_stop", body.EndStop, "arm", "position", end_stop, (("arm", "end_stop"),),
               (("gearbox", "end_stop"), ("motor", "end_stop")), BODIES),
        Effect("motor_mode", body.AdditionalMode, "motor", "mode", mode("motor"), (("motor", "additional_mode"),),
               (("gearbox", "additional_mode"),), ("motor", "gearbox")),
        Effect("arm_mode", body.AdditionalMode, "arm", "mode", mode("arm"), (("arm", "additional_mode"),),
               (("gearbox", "additional_mode"),), ("arm", "gearbox")),
    ]  # fmt: skip


def _coupling_effects() -> list[Effect]:
    def hysteron(low: float, high: float, reach: float) -> Draw:
        def draw(g: Generator, s: float, c: Surroundings) -> Switches:
            slip, yielding = s * g.uniform(low, high), reach * g.uniform(0.6, 1.2)
            return {"stiffness": slip / yielding, "yield": yielding}

        return draw

    def elastic(port: str) -> tuple[Pair, ...]:
        return ((port, "nonlinear_stiffness"), (port, "hysteretic_spring"))

    def error(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"amplitude": s * g.uniform(0.012, 0.022), "order": float(g.integers(2, 9)), "phase": _phase(g)}

    gear, arm = "gear_spring", "arm_spring"
    return [
        Effect("backlash", coupling.Backlash, gear, "gear", lambda g, s, c: {"half_gap": s * g.uniform(0.03, 0.045)},
               ((gear, "backlash"),), elastic(gear), (gear,)),
        Effect("arm_backlash", coupling.Backlash, arm, "arm_spring", lambda g, s, c: {"half_gap": s * g.uniform(0.02, 0.035)},
               ((arm, "backlash"),), elastic(arm), (arm,)),
        Effect("arm_stiffening", coupling.CubicStiffness, arm, "arm_spring",
               lambda g, s, c: {"cubic": s * g.uniform(150.0, 300.0)}, ((arm, "nonlinear_stiffness"),),
               (), (arm,)),
        Effect("arm_softening", coupling.SofteningSpring, arm, "arm_spring",
               lambda g, s, c: {"level": s * g.uniform(0.2, 0.35), "d_0": g.uniform(0.02, 0.03)},
               ((arm, "nonlinear_stiffness"),), ((arm, "hysteretic_spring"),), (arm,)),
        Effect("gear_hysteresis", coupling.HystereticSpring, gear, "gear", hysteron(0.25, 0.4, 0.04),
               ((gear, "hysteretic_spring"),),
               ((gear, "nonlinear_stiffness"), (gear, "nonlinear_damping")), (gear,)),
        Effect("arm_hysteresis", coupling.HystereticSpring, arm, "arm_spring", hysteron(0.12, 0.22, 0.01),
               ((arm, "hysteretic_spring"),), ((arm, "nonlinear_stiffness"), (arm, "nonlinear_damping")), (arm,)),
        Effect("gear_damping", coupling.QuadraticDamping, gear, "gear", lambda g, s, c: {"c": s * g.uniform(0.012, 0.024)},
               ((gear, "nonlinear_damping"),), ((gear, "hysteretic_spring"),), (gear,)),
        Effect("arm_damping", coupling.QuadraticDamping, arm, "arm_spring",
               lambda g, s, c: {"c": s * g.uniform(0.04, 0.08)},
               ((arm, "nonlinear_damping"),), ((arm, "hysteretic_spring"),), (arm,)),
        Effect("transmission_error", coupling.TransmissionError, gear, "position", error,
               ((gear, "transmission_error"),), (("motor", "torque_ripple"), ("gearbox", "torque_ripple")), (gear,)),
    ]  # fmt: skip


def _drive_effects() -> list[Effect]:
    def delay(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"delay": s * g.uniform(0.001, 0.003)}

    return [
        Effect("input_delay", drive.InputDelay, "actuator", "timing",
               delay, DELAY, LAG, ("actuator", "sensor")),
        Effect("output_delay", drive.OutputDelay, "sensor", "timing",
               delay, DELAY, LAG, ("actuator", "sensor")),
        Effect("input_lag", drive.InputLag, "actuator", "timing", lambda g, s, c: {"T": s * g.uniform(0.0015, 0.0035)},
               LAG[:1], (*DELAY, LAG[1]), ("actuator",)),
        Effect("sensor_lag", drive.SensorLag, "sensor", "timing", lambda g, s, c: {"T": s * g.uniform(0.0015, 0.0035)},
               LAG[1:], (*DELAY, LAG[0]), ("sensor",)),
        Effect("input_bias", drive.InputBias, "actuator", "bias",
               lambda g, s, c: {"bias": s * _sign(g) * g.uniform(0.03, 0.1)}, BIAS, (("motor", "coulomb_asymmetry"),),
               ("motor", "gearbox", "arm", "actuator")),
        Effect("saturation", drive.TorqueSaturation, "actuator", "actuator",
               lambda g, s, c: {"limit": g.uniform(8.0, 10.0) / s**0.2}, (("actuator", "torque_saturation"),), (),
               ("actuator",)),
        Effect("deadzone", drive.ActuatorDeadzone, "actuator", "actuator",
               lambda g, s, c: {"half_width": s * g.uniform(0.1, 0.2)}, (("actuator", "actuator_deadzone"),), (),
               ("actuator",)),
        Effect("sensor_bias", drive.SensorBias, "sensor", "bias",
               lambda g, s, c: {"bias": s * _sign(g) * g.uniform(0.25, 0.6)}, (("sensor", "sensor_bias"),), (),
               ("sensor",)),
    ]  # fmt: skip


def _outside_effects() -> list[Effect]:
    def bump(g: Generator, s: float, c: Surroundings) -> Switches:
        return {
            "height": s * g.uniform(0.4, 0.7),
            "center": g.uniform(12.0, 22.0),
            "width": g.uniform(1.8, 3.0),
            "v_0": 1.0,
        }

    def notch(g: Generator, s: float, c: Surroundings) -> Switches:
        center = _between(c.position[:, 0], g.uniform(0.35, 0.75))
        return {"height": s * g.uniform(1.0, 2.0), "center": center, "width": g.uniform(0.5, 1.0)}

    def tuned(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"c": s * g.uniform(0.06, 0.12), "center": g.uniform(17.0, 23.0), "width": g.uniform(1.5, 3.0)}

    return [
        Effect("speed_bump", body.SpeedBump, "motor", "outside", bump, (("motor", "unknown"),), (), ("motor",), True),
        Effect("notch", body.Notch, "motor", "outside", notch, (("motor", "unknown"),), (("gearbox", "unknown"),),
               ("motor", "gearbox"), True),
        Effect("arm_waves", coupling.WavySpring, "arm_spring", "outside",
               lambda g, s, c: {"height": s * g.uniform(0.2, 0.35), "spacing": g.uniform(0.015, 0.025)},
               (("arm_spring", "unknown"),), (("arm_spring", "nonlinear_stiffness"),), ("arm_spring",), True),
        Effect("tuned_damping", coupling.SpeedTunedDamping, "gear_spring", "outside", tuned,
               (("gear_spring", "unknown"),), (("gear_spring", "nonlinear_damping"),), ("gear_spring",), True),
        Effect("torque_fade", drive.TorqueFade, "actuator", "outside", lambda g, s, c: {"loss": s * g.uniform(0.12, 0.25), "top": 40.0},
               (("actuator", "unknown"), ("motor", "unknown")), (("actuator", "input_gain"),), ("actuator", "motor"), True),
        Effect("speed_waves", body.SpeedWaves, "gearbox", "outside",
               lambda g, s, c: {"height": s * g.uniform(0.4, 0.7), "spacing": g.uniform(2.0, 3.5), "v_0": 1.0},
               (("gearbox", "unknown"),), (("motor", "unknown"), ("arm", "unknown")), ("gearbox", "motor"), True),
    ]  # fmt: skip


def _sharp_effects() -> list[Effect]:
    near = (("gearbox", "coulomb_friction"), ("gearbox", "stribeck_friction"), ("arm", "presliding_hysteresis"))
    gear = "gear_spring"

    def seat(g: Generator, s: float, c: Surroundings) -> Switches:
        level, reach = s * g.uniform(0.25, 0.4), g.uniform(0.03, 0.08)
        return {"level": level, "stiffness": level / reach, "damping": 0.02 * level}

    def lugre(g: Generator, s: float, c: Surroundings) -> Switches:
        level, reach = s * g.uniform(0.12, 0.2), g.uniform(0.02, 0.05)
        return {
            "level": level, "extra": level * g.uniform(0.8, 1.5), "v_s": g.uniform(3.0, 6.0), "c": s * g.uniform(0.001, 0.003),
            "stiffness": level / reach, "damping": 0.02 * level,
        }  # fmt: skip

    def loop(g: Generator, s: float, c: Surroundings) -> Switches:
        slip, yielding = s * g.uniform(0.25, 0.4), g.uniform(0.024, 0.048)
        share, power = g.uniform(0.55, 0.95), g.uniform(1.0, 3.0)
        return {"stiffness": slip / yielding, "yield": yielding, "share": share, "power": power}

    return [
        Effect("arm_stick", dry.DryCoulomb, "arm", "friction", lambda g, s, c: {"level": s * g.uniform(0.25, 0.45)},
               (("arm", "coulomb_friction"), ("arm", "stribeck_friction")), near, ("arm", "gearbox"), sharp=True),
        Effect("arm_stick_slip", dry.DryStribeck, "arm", "friction",
               lambda g, s, c: {"level": s * g.uniform(0.12, 0.2), "extra": s * g.uniform(0.3, 0.45), "v_s": g.uniform(3.0, 6.0)},
               (("arm", "stribeck_friction"),), (("arm", "coulomb_friction"), *near), ("arm", "gearbox"), sharp=True),
        Effect("gear_impacts", coupling.BacklashWithImpacts, gear, "gear", lambda g, s, c: {"half_gap": s * g.uniform(0.03, 0.045)},
               ((gear, "backlash"),), ((gear, "nonlinear_stiffness"), (gear, "hysteretic_spring")), (gear,), sharp=True),
        Effect(
            name="motor_seat", law=dry.DryPresliding, port="motor", family="bristle", draw=seat,
            accept=(("motor", "presliding_hysteresis"),),
            near=(("gearbox", "presliding_hysteresis"), ("motor", "coulomb_friction"), ("motor", "stribeck_friction")),
            ports=("motor", "gearbox"), sharp=True,
        ),
        Effect(
            name="arm_lugre", law=body.StribeckBristle, port="arm", family="friction", draw=lugre,
            accept=(("arm", "presliding_hysteresis"), ("arm", "stribeck_friction")),
            near=(("arm", "coulomb_friction"), *(("gearbox", name) for name in DRY_NAMES)),
            ports=("arm", "gearbox"), sharp=True,
        ),
        Effect(
            name="gear_bouc_wen", law=coupling.BoucWen, port=gear, family="gear", draw=loop,
            accept=((gear, "hysteretic_spring"),), near=((gear, "nonlinear_stiffness"), (gear, "nonlinear_damping")),
            ports=(gear,), sharp=True,
        ),
    ]  # fmt: skip


CATALOGUE: dict[str, Effect] = {
    effect.name: effect
    for effect in (
        *_friction_effects(),
        *_force_effects(),
        *_coupling_effects(),
        *_drive_effects(),
        *_outside_effects(),
        *_sharp_effects(),
    )
}
LIBRARY = tuple(name for name, effect in CATALOGUE.items() if not (effect.outside or effect.sharp))
OUTSIDE = tuple(name for name, effect in CATALOGUE.items() if effect.outside)
