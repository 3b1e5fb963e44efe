"""Forces on the arm's bodies that are not friction, and further masses."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from experiments.concealed.catalogue.arm_twins import BIAS, BODIES
from experiments.concealed.effects import Draw, Effect, Surroundings, Switches, phase, sign
from experiments.concealed.laws import body


def force_effects() -> list[Effect]:
    def ripple(g: Generator, s: float, c: Surroundings) -> Switches:
        order = float(np.round(np.exp(g.uniform(np.log(2.0), np.log(40.0)))))
        amplitude = s * g.uniform(0.2, 0.35) * max(1.0, order / 12.0)  # inertia hides the fast ones
        return {"amplitude": amplitude, "order": order, "phase": phase(g)}

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
        return {"moment": s * g.uniform(0.3, 0.7), "angle": phase(g)}

    return [
        Effect(
            name="constant_bias",
            law=body.ConstantBias,
            port="motor",
            family="bias",
            draw=lambda g, s, c: {"bias": s * sign(g) * g.uniform(0.03, 0.1)},
            accept=BIAS,
            near=(("motor", "coulomb_asymmetry"),),
            ports=("motor", "gearbox", "arm", "actuator"),
        ),
        Effect(
            name="gravity",
            law=body.Gravity,
            port="arm",
            family="position",
            draw=gravity,
            accept=tuple((b, "gravity") for b in ("arm", "gearbox", "motor")),
            near=(("motor", "torque_ripple"),),
            ports=BODIES,
        ),
        Effect(
            name="ripple",
            law=body.TorqueRipple,
            port="motor",
            family="position",
            draw=ripple,
            accept=(("motor", "torque_ripple"), ("actuator", "torque_ripple")),
            near=(
                ("motor", "position_dependent_friction"),
                ("gearbox", "torque_ripple"),
                ("gear_spring", "transmission_error"),
            ),
            ports=("motor", "actuator"),
        ),
        Effect(
            name="end_stop",
            law=body.EndStop,
            port="arm",
            family="position",
            draw=end_stop,
            accept=(("arm", "end_stop"),),
            near=(("gearbox", "end_stop"), ("motor", "end_stop")),
            ports=BODIES,
        ),
        Effect(
            name="motor_mode",
            law=body.AdditionalMode,
            port="motor",
            family="mode",
            draw=mode("motor"),
            accept=(("motor", "additional_mode"),),
            near=(("gearbox", "additional_mode"),),
            ports=("motor", "gearbox"),
        ),
        Effect(
            name="arm_mode",
            law=body.AdditionalMode,
            port="arm",
            family="mode",
            draw=mode("arm"),
            accept=(("arm", "additional_mode"),),
            near=(("gearbox", "additional_mode"),),
            ports=("arm", "gearbox"),
        ),
    ]
