"""What the arm's two springs may hide."""

from __future__ import annotations

from numpy.random import Generator

from experiments.concealed.effects import Draw, Effect, Pair, Surroundings, Switches, phase
from experiments.concealed.laws import coupling


def coupling_effects() -> list[Effect]:
    def hysteron(low: float, high: float, reach: float) -> Draw:
        def draw(g: Generator, s: float, c: Surroundings) -> Switches:
            slip, yielding = s * g.uniform(low, high), reach * g.uniform(0.6, 1.2)
            return {"stiffness": slip / yielding, "yield": yielding}

        return draw

    def elastic(port: str) -> tuple[Pair, ...]:
        return ((port, "nonlinear_stiffness"), (port, "hysteretic_spring"))

    def error(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"amplitude": s * g.uniform(0.012, 0.022), "order": float(g.integers(2, 9)), "phase": phase(g)}

    gear, arm = "gear_spring", "arm_spring"
    return [
        Effect(
            name="backlash",
            law=coupling.Backlash,
            port=gear,
            family="gear",
            draw=lambda g, s, c: {"half_gap": s * g.uniform(0.03, 0.045)},
            accept=((gear, "backlash"),),
            near=elastic(gear),
            ports=(gear,),
        ),
        Effect(
            name="arm_backlash",
            law=coupling.Backlash,
            port=arm,
            family="arm_spring",
            draw=lambda g, s, c: {"half_gap": s * g.uniform(0.02, 0.035)},
            accept=((arm, "backlash"),),
            near=elastic(arm),
            ports=(arm,),
        ),
        Effect(
            name="arm_stiffening",
            law=coupling.CubicStiffness,
            port=arm,
            family="arm_spring",
            draw=lambda g, s, c: {"cubic": s * g.uniform(150.0, 300.0)},
            accept=((arm, "nonlinear_stiffness"),),
            ports=(arm,),
        ),
        Effect(
            name="arm_softening",
            law=coupling.SofteningSpring,
            port=arm,
            family="arm_spring",
            draw=lambda g, s, c: {"level": s * g.uniform(0.2, 0.35), "d_0": g.uniform(0.02, 0.03)},
            accept=((arm, "nonlinear_stiffness"),),
            near=((arm, "hysteretic_spring"),),
            ports=(arm,),
        ),
        Effect(
            name="gear_hysteresis",
            law=coupling.HystereticSpring,
            port=gear,
            family="gear",
            draw=hysteron(0.25, 0.4, 0.04),
            accept=((gear, "hysteretic_spring"),),
            near=((gear, "nonlinear_stiffness"), (gear, "nonlinear_damping")),
            ports=(gear,),
        ),
        Effect(
            name="arm_hysteresis",
            law=coupling.HystereticSpring,
            port=arm,
            family="arm_spring",
            draw=hysteron(0.12, 0.22, 0.01),
            accept=((arm, "hysteretic_spring"),),
            near=((arm, "nonlinear_stiffness"), (arm, "nonlinear_damping")),
            ports=(arm,),
        ),
        Effect(
            name="gear_damping",
            law=coupling.QuadraticDamping,
            port=gear,
            family="gear",
            draw=lambda g, s, c: {"c": s * g.uniform(0.012, 0.024)},
            accept=((gear, "nonlinear_damping"),),
            near=((gear, "hysteretic_spring"),),
            ports=(gear,),
        ),
        Effect(
            name="arm_damping",
            law=coupling.QuadraticDamping,
            port=arm,
            family="arm_spring",
            draw=lambda g, s, c: {"c": s * g.uniform(0.04, 0.08)},
            accept=((arm, "nonlinear_damping"),),
            near=((arm, "hysteretic_spring"),),
            ports=(arm,),
        ),
        Effect(
            name="transmission_error",
            law=coupling.TransmissionError,
            port=gear,
            family="position",
            draw=error,
            accept=((gear, "transmission_error"),),
            near=(("motor", "torque_ripple"), ("gearbox", "torque_ripple")),
            ports=(gear,),
        ),
    ]
