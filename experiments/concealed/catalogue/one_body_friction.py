"""Friction of a machine with one body, plain and richer than the library's laws, in the machine's own units."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.random import Generator

from experiments.concealed.effects import Effect, Surroundings, Switches
from experiments.concealed.laws import body, dry


@dataclass(frozen=True)
class Usual:
    """What is usual in a machine: force, speed, half the travel; how far a bristle bends; the body's name."""

    body: str
    force: float
    speed: float
    travel: float
    bristle: float


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
        Effect(
            name="coulomb",
            law=dry.DryCoulomb,
            port=at,
            family="friction",
            draw=coulomb,
            accept=((at, "coulomb_friction"), (at, "stribeck_friction")),
            near=((at, "presliding_hysteresis"),),
            ports=(at,),
        ),
        Effect(
            name="stribeck",
            law=dry.DryStribeck,
            port=at,
            family="friction",
            draw=stribeck,
            accept=((at, "stribeck_friction"),),
            near=near["stribeck_friction"],
            ports=(at,),
        ),
        Effect(
            name="presliding",
            law=body.Bristle,
            port=at,
            family="friction",
            draw=bristle,
            accept=((at, "presliding_hysteresis"),),
            near=near["presliding_hysteresis"],
            ports=(at,),
        ),
        Effect(
            name="quadratic_drag",
            law=body.QuadraticDrag,
            port=at,
            family="drag",
            draw=lambda g, s, c: {"c": s * u.force / u.speed**2 * g.uniform(0.04, 0.08)},
            accept=((at, "quadratic_drag"),),
            ports=(at,),
        ),
        Effect(
            name="warmup",
            law=dry.DryWarmup,
            port=at,
            family="friction",
            draw=warmup,
            accept=((at, "friction_warmup"),),
            near=((at, "coulomb_friction"), (at, "stribeck_friction")),
            ports=(at,),
        ),
    ]


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
            name="seat",
            law=dry.DryPresliding,
            port=at,
            family="friction",
            draw=seat,
            accept=(bristle,),
            near=(stribeck, plain),
            ports=(at,),
            sharp=True,
        ),
        Effect(
            name="lugre",
            law=body.StribeckBristle,
            port=at,
            family="friction",
            draw=lugre,
            accept=(bristle, stribeck),
            near=(plain,),
            ports=(at,),
            sharp=True,
        ),
        Effect(
            name="hard_end_stop",
            law=dry.HardStop,
            port=at,
            family="position",
            draw=hit,
            accept=((at, "end_stop"),),
            near=((at, "unknown"),),
            ports=(at,),
            sharp=True,
        ),
    ]
