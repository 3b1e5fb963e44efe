"""Friction of the arm's bodies."""

from __future__ import annotations

from numpy.random import Generator

from experiments.concealed.catalogue.arm_twins import BIAS, BODIES
from experiments.concealed.effects import Draw, Effect, Pair, Surroundings, Switches, phase
from experiments.concealed.laws import body


def friction_effects() -> list[Effect]:
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
        Effect(
            name="arm_viscous",
            law=body.Viscous,
            port="arm",
            family="viscous",
            draw=lambda g, s, c: {"c": s * g.uniform(0.01, 0.02)},
            accept=at("viscous_friction", "arm"),
            near=at("viscous_friction", "gearbox"),
            ports=("arm", "gearbox"),
        ),
        Effect(
            name="gearbox_viscous",
            law=body.Viscous,
            port="gearbox",
            family="viscous",
            draw=lambda g, s, c: {"c": s * g.uniform(0.015, 0.03)},
            accept=at("viscous_friction", "gearbox"),
            near=at("viscous_friction", "arm"),
            ports=("gearbox", "arm"),
        ),
        Effect(
            name="arm_coulomb",
            law=body.Coulomb,
            port="arm",
            family="friction",
            draw=coulomb(0.25, 0.45),
            accept=at("coulomb_friction", "arm") + at("stribeck_friction", "arm"),
            near=at("coulomb_friction", "gearbox") + at("stribeck_friction", "gearbox"),
            ports=("arm", "gearbox"),
        ),
        Effect(
            name="gearbox_coulomb",
            law=body.Coulomb,
            port="gearbox",
            family="friction",
            draw=coulomb(0.3, 0.5),
            accept=at("coulomb_friction", "gearbox") + at("stribeck_friction", "gearbox"),
            near=at("coulomb_friction", "arm") + at("stribeck_friction", "arm"),
            ports=("gearbox", "arm"),
        ),
        Effect(
            name="arm_stribeck",
            law=body.Stribeck,
            port="arm",
            family="friction",
            draw=stribeck,
            accept=at("stribeck_friction", "arm"),
            near=at("coulomb_friction", "arm", "gearbox") + at("stribeck_friction", "gearbox"),
            ports=("arm", "gearbox"),
        ),
        Effect(
            name="asymmetry",
            law=body.CoulombAsymmetry,
            port="motor",
            family="bias",
            draw=lambda g, s, c: {
                "difference": min(s * g.uniform(0.07, 0.15), 0.9) * c.truth["F_c"],
                "v_0": 1.0 / c.truth["beta"],
            },
            accept=at("coulomb_asymmetry", "motor"),
            near=BIAS,
            ports=("motor", "actuator"),
        ),
        Effect(
            name="quadratic_drag",
            law=body.QuadraticDrag,
            port="motor",
            family="drag",
            draw=lambda g, s, c: {"c": s * g.uniform(0.0008, 0.0016)},
            accept=at("quadratic_drag", "motor"),
            near=at("quadratic_drag", "gearbox", "arm"),
            ports=BODIES,
        ),
        Effect(
            name="load_friction",
            law=body.LoadDependentFriction,
            port="motor",
            family="load",
            draw=lambda g, s, c: {"c": min(s * g.uniform(0.1, 0.18), 0.8), "v_0": 1.0 / c.truth["beta"]},
            accept=at("load_dependent_friction", "motor", "gearbox"),
            ports=("motor", "gearbox"),
        ),
        Effect(
            name="position_friction",
            law=body.PositionDependentFriction,
            port="motor",
            family="position",
            draw=lambda g, s, c: {
                "level": s * g.uniform(0.15, 0.3),
                "order": float(g.integers(1, 5)),
                "phase": phase(g),
                "v_0": 0.5,
            },
            accept=at("position_dependent_friction", "motor"),
            near=at("position_dependent_friction", "gearbox") + at("torque_ripple", "motor"),
            ports=("motor", "gearbox"),
        ),
        Effect(
            name="warmup",
            law=body.FrictionWarmup,
            port="motor",
            family="time",
            draw=warmup,
            accept=at("friction_warmup", "motor"),
            near=at("friction_warmup", "gearbox", "arm"),
            ports=("motor", "gearbox"),
        ),
        Effect(
            name="presliding",
            law=body.Bristle,
            port="motor",
            family="bristle",
            draw=bristle,
            accept=at("presliding_hysteresis", "motor"),
            near=at("presliding_hysteresis", "gearbox")
            + at("coulomb_friction", "motor")
            + at("stribeck_friction", "motor"),
            ports=("motor", "gearbox"),
        ),
    ]
