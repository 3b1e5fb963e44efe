"""Physics of a machine with one body that no mechanism of the library describes, in the machine's own units."""

from __future__ import annotations

from numpy.random import Generator

from experiments.concealed.catalogue.one_body_friction import Usual
from experiments.concealed.effects import Effect, Surroundings, Switches
from experiments.concealed.laws import body, drive


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
        Effect(
            name="speed_bump",
            law=body.SpeedBump,
            port=at,
            family="outside",
            draw=bump,
            accept=unknown,
            ports=(at,),
            outside=True,
        ),
        Effect(
            name="notch",
            law=body.Notch,
            port=at,
            family="outside",
            draw=notch,
            accept=unknown,
            ports=(at,),
            outside=True,
        ),
        Effect(
            name="speed_waves",
            law=body.SpeedWaves,
            port=at,
            family="outside",
            draw=waves,
            accept=unknown,
            ports=(at,),
            outside=True,
        ),
        Effect(
            name="torque_fade",
            law=drive.TorqueFade,
            port="actuator",
            family="outside",
            draw=fade,
            accept=(("actuator", "unknown"), *unknown),
            near=(("actuator", "input_gain"),),
            ports=("actuator", at),
            outside=True,
        ),
    ]
