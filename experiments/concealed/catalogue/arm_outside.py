"""Physics of the arm that no mechanism of the library describes: the right answer is `unknown`, at the right place."""

from __future__ import annotations

from numpy.random import Generator

from experiments.concealed.effects import Effect, Surroundings, Switches, between
from experiments.concealed.laws import body, coupling, drive


def outside_effects() -> list[Effect]:
    def bump(g: Generator, s: float, c: Surroundings) -> Switches:
        return {
            "height": s * g.uniform(0.4, 0.7),
            "center": g.uniform(12.0, 22.0),
            "width": g.uniform(1.8, 3.0),
            "v_0": 1.0,
        }

    def notch(g: Generator, s: float, c: Surroundings) -> Switches:
        center = between(c.position[:, 0], g.uniform(0.35, 0.75))
        return {"height": s * g.uniform(1.0, 2.0), "center": center, "width": g.uniform(0.5, 1.0)}

    def tuned(g: Generator, s: float, c: Surroundings) -> Switches:
        return {"c": s * g.uniform(0.06, 0.12), "center": g.uniform(17.0, 23.0), "width": g.uniform(1.5, 3.0)}

    return [
        Effect(
            name="speed_bump",
            law=body.SpeedBump,
            port="motor",
            family="outside",
            draw=bump,
            accept=(("motor", "unknown"),),
            ports=("motor",),
            outside=True,
        ),
        Effect(
            name="notch",
            law=body.Notch,
            port="motor",
            family="outside",
            draw=notch,
            accept=(("motor", "unknown"),),
            near=(("gearbox", "unknown"),),
            ports=("motor", "gearbox"),
            outside=True,
        ),
        Effect(
            name="arm_waves",
            law=coupling.WavySpring,
            port="arm_spring",
            family="outside",
            draw=lambda g, s, c: {"height": s * g.uniform(0.2, 0.35), "spacing": g.uniform(0.015, 0.025)},
            accept=(("arm_spring", "unknown"),),
            near=(("arm_spring", "nonlinear_stiffness"),),
            ports=("arm_spring",),
            outside=True,
        ),
        Effect(
            name="tuned_damping",
            law=coupling.SpeedTunedDamping,
            port="gear_spring",
            family="outside",
            draw=tuned,
            accept=(("gear_spring", "unknown"),),
            near=(("gear_spring", "nonlinear_damping"),),
            ports=("gear_spring",),
            outside=True,
        ),
        Effect(
            name="torque_fade",
            law=drive.TorqueFade,
            port="actuator",
            family="outside",
            draw=lambda g, s, c: {"loss": s * g.uniform(0.12, 0.25), "top": 40.0},
            accept=(("actuator", "unknown"), ("motor", "unknown")),
            near=(("actuator", "input_gain"),),
            ports=("actuator", "motor"),
            outside=True,
        ),
        Effect(
            name="speed_waves",
            law=body.SpeedWaves,
            port="gearbox",
            family="outside",
            draw=lambda g, s, c: {"height": s * g.uniform(0.4, 0.7), "spacing": g.uniform(2.0, 3.5), "v_0": 1.0},
            accept=(("gearbox", "unknown"),),
            near=(("motor", "unknown"), ("arm", "unknown")),
            ports=("gearbox", "motor"),
            outside=True,
        ),
    ]
