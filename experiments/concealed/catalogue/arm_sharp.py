"""Physics of the arm with an edge, or richer than the library's laws; for the proof alone."""

from __future__ import annotations

from numpy.random import Generator

from experiments.concealed.catalogue.arm_twins import DRY_NAMES
from experiments.concealed.effects import Effect, Surroundings, Switches
from experiments.concealed.laws import body, coupling, dry


def sharp_effects() -> list[Effect]:
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
        Effect(
            name="arm_stick",
            law=dry.DryCoulomb,
            port="arm",
            family="friction",
            draw=lambda g, s, c: {"level": s * g.uniform(0.25, 0.45)},
            accept=(("arm", "coulomb_friction"), ("arm", "stribeck_friction")),
            near=near,
            ports=("arm", "gearbox"),
            sharp=True,
        ),
        Effect(
            name="arm_stick_slip",
            law=dry.DryStribeck,
            port="arm",
            family="friction",
            draw=lambda g, s, c: {
                "level": s * g.uniform(0.12, 0.2),
                "extra": s * g.uniform(0.3, 0.45),
                "v_s": g.uniform(3.0, 6.0),
            },
            accept=(("arm", "stribeck_friction"),),
            near=(("arm", "coulomb_friction"), *near),
            ports=("arm", "gearbox"),
            sharp=True,
        ),
        Effect(
            name="gear_impacts",
            law=coupling.BacklashWithImpacts,
            port=gear,
            family="gear",
            draw=lambda g, s, c: {"half_gap": s * g.uniform(0.03, 0.045)},
            accept=((gear, "backlash"),),
            near=((gear, "nonlinear_stiffness"), (gear, "hysteretic_spring")),
            ports=(gear,),
            sharp=True,
        ),
        Effect(
            name="motor_seat",
            law=dry.DryPresliding,
            port="motor",
            family="bristle",
            draw=seat,
            accept=(("motor", "presliding_hysteresis"),),
            near=(("gearbox", "presliding_hysteresis"), ("motor", "coulomb_friction"), ("motor", "stribeck_friction")),
            ports=("motor", "gearbox"),
            sharp=True,
        ),
        Effect(
            name="arm_lugre",
            law=body.StribeckBristle,
            port="arm",
            family="friction",
            draw=lugre,
            accept=(("arm", "presliding_hysteresis"), ("arm", "stribeck_friction")),
            near=(("arm", "coulomb_friction"), *(("gearbox", name) for name in DRY_NAMES)),
            ports=("arm", "gearbox"),
            sharp=True,
        ),
        Effect(
            name="gear_bouc_wen",
            law=coupling.BoucWen,
            port=gear,
            family="gear",
            draw=loop,
            accept=((gear, "hysteretic_spring"),),
            near=((gear, "nonlinear_stiffness"), (gear, "nonlinear_damping")),
            ports=(gear,),
            sharp=True,
        ),
    ]
