"""Entries that several machines have in their catalogues, with the answers that are right, near and at the right place."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from numpy.random import Generator

from experiments.concealed.workshop import laws
from experiments.concealed.workshop.plant import Concealed, Entry, Pair, Port, Seen

DRY = ("coulomb_friction", "stribeck_friction")
Range = tuple[float, float]


@dataclass(frozen=True)
class Place:
    """A port, and what is usual there: the force that matters.

    `behind`: ports of bodies that move nearly alike; `drive`: the actuator whose input is a force on this very body.
    """

    name: str
    port: Port
    force: Range
    behind: tuple[str, ...] = ()
    drive: str = ""

    @property
    def pushed(self) -> tuple[Pair, ...]:
        """A bias of the drive is a constant force on the body."""
        return ((self.drive, "input_bias"),) if self.drive else ()


def _at(place: Place, draw: Callable[[Generator, Seen], laws.PortLaw]) -> Callable[[Generator, Seen], Concealed]:
    return lambda g, c: Concealed([(place.name, draw(g, c))])


def _pairs(place: Place, *names: str) -> tuple[Pair, ...]:
    return tuple((place.name, name) for name in names)


def _behind(place: Place, *names: str) -> tuple[Pair, ...]:
    return tuple((other, name) for other in place.behind for name in names)


def dry(place: Place) -> dict[str, Entry]:
    """Dry friction of four kinds: true sticking, Stribeck with true sticking, LuGre, uneven."""
    name = place.name
    near = _pairs(place, "presliding_hysteresis", "hysteretic_spring") + _behind(place, *DRY)

    def lugre(g: Generator, c: Seen) -> laws.PortLaw:
        usual, level = c.usual(place.port.rate), g.uniform(*place.force)
        low, high = c.reach(place.port.position)
        travel = high - low or usual  # a second's worth where the port has no position
        return laws.lugre(
            level, level * g.uniform(0.1, 0.5), usual * g.uniform(0.03, 0.1), travel * g.uniform(0.002, 0.02)
        )

    return {
        f"{name}_coulomb": Entry(
            _at(place, lambda g, c: laws.coulomb(g.uniform(*place.force))), _pairs(place, *DRY), near, family=name
        ),
        f"{name}_stribeck": Entry(
            _at(
                place,
                lambda g, c: laws.stribeck(
                    g.uniform(*place.force),
                    g.uniform(*place.force) * g.uniform(0.3, 0.8),
                    c.usual(place.port.rate) * g.uniform(0.1, 0.4),
                ),
            ),
            _pairs(place, *DRY), near, family=name,
        ),
        f"{name}_lugre": Entry(
            _at(place, lugre),
            _pairs(place, *DRY, "presliding_hysteresis"), _pairs(place, "hysteretic_spring") + _behind(place, *DRY), family=name,
        ),
        f"{name}_uneven": Entry(
            _at(
                place,
                lambda g, c: (
                    lambda level: laws.uneven(level, level * g.uniform(0.4, 0.8) * (1 if g.random() < 0.5 else -1))
                )(g.uniform(*place.force)),
            ),
            _pairs(place, *DRY), near, family=name,
            # where dry friction truly sticks, levels that differ are a bias beside their mean
            beside=(Entry(_at(place, lambda g, c: laws.coulomb(0.0)), _pairs(place, "coulomb_asymmetry", "constant_bias") + place.pushed),),
        ),
    }  # fmt: skip


def drag(place: Place, *, force: Range) -> dict[str, Entry]:
    """Drag of the speed's square; `force` at twice the usual speed."""
    return {
        f"{place.name}_drag": Entry(
            _at(place, lambda g, c: laws.drag(g.uniform(*force) / (2.0 * c.usual(place.port.rate)) ** 2)),
            _pairs(place, "quadratic_drag"),
            _pairs(place, "viscous_friction") + _behind(place, "quadratic_drag"),
            family=place.name,
        )
    }


def stops(place: Place) -> dict[str, Entry]:
    """A buffer, and a wall that throws the motion back, on the way of the first experiment."""

    def reached(g: Generator, c: Seen) -> float:
        low, high = c.reach(place.port.position)
        return high - g.uniform(0.08, 0.25) * (high - low)

    def buffer(g: Generator, c: Seen) -> laws.PortLaw:
        low, high = c.reach(place.port.position)
        stiffness = place.force[1] * g.uniform(20.0, 80.0) / (high - low)
        return laws.elastic_stop(
            reached(g, c), stiffness, place.force[1] * g.uniform(0.1, 0.5) / c.usual(place.port.rate)
        )

    stop = _pairs(place, "end_stop")
    near = _pairs(place, "unknown", "nonlinear_stiffness")
    return {
        f"{place.name}_buffer": Entry(_at(place, buffer), stop, near, family=place.name),
        f"{place.name}_wall": Entry(
            _at(place, lambda g, c: laws.Impact(reached(g, c), g.uniform(0.1, 0.6))), stop, near, family=place.name
        ),
    }


def actuator(
    port: str,
    channel: str,
    *,
    index: int,
    timing: Range,
    gain: bool = False,
    dead: bool = True,
    limit: bool = True,
    level: bool = True,
    body: str = "",
) -> dict[str, Entry]:
    """Delay, lag, limit, dead zone, gain and bias of an input. `timing`: of delay and lag [s]; `body`: on which it is a force."""

    def change(name: str, value: Callable[[Generator, Seen], float]) -> Callable[[Generator, Seen], Concealed]:
        return lambda g, c: Concealed(actuators={channel: {name: float(value(g, c))}})

    def peak(c: Seen) -> float:
        return float(abs(c.inputs[0][:, index]).max())

    family = f"actuator {channel}"
    late, slow = (port, "input_delay"), (port, "input_lag")
    found = {
        f"{channel}_delay": Entry(
            change("delay", lambda g, c: g.uniform(*timing)), (late,), (slow, (port, "unknown")), family=f"{family} late"
        ),
        f"{channel}_lag": Entry(change("lag", lambda g, c: g.uniform(*timing)), (slow,), (late,), family=f"{family} slow"),
    }  # fmt: skip
    if limit:
        found[f"{channel}_limit"] = Entry(
            change("limit", lambda g, c: peak(c) * g.uniform(0.45, 0.8)), ((port, "torque_saturation"),),
            ((port, "unknown"),), family=family,
        )  # fmt: skip
    if dead:
        found[f"{channel}_dead"] = Entry(
            change("dead", lambda g, c: peak(c) * g.uniform(0.03, 0.12)), ((port, "actuator_deadzone"),),
            ((port, "unknown"),), family=family,
        )  # fmt: skip
    if gain:
        found[f"{channel}_gain"] = Entry(
            change("gain", lambda g, c: 1.0 + g.uniform(0.06, 0.2) * (1 if g.random() < 0.5 else -1)),
            ((port, "input_gain"),), family=family,
        )  # fmt: skip
    if level:
        found[f"{channel}_bias"] = Entry(
            change("bias", lambda g, c: peak(c) * g.uniform(0.03, 0.1) * (1 if g.random() < 0.5 else -1)),
            ((port, "input_bias"), *([(body, "constant_bias")] if body else [])), family=family,
        )  # fmt: skip
    return found


def sensor(port: str, channel: str, *, timing: Range, accept: tuple[Pair, ...] = ()) -> dict[str, Entry]:
    """Delay and lag of a sensor. `accept`: what is the same there."""

    def change(name: str, value: Callable[[Generator], float]) -> Callable[[Generator, Seen], Concealed]:
        return lambda g, c: Concealed(sensors={channel: {name: float(value(g))}})

    late, slow = (port, "output_delay"), (port, "sensor_lag")
    family = f"sensor {channel}"
    return {
        f"{channel}_late": Entry(
            change("delay", lambda g: g.uniform(*timing)), (late, *accept), (slow,), family=family
        ),
        f"{channel}_slow": Entry(change("lag", lambda g: g.uniform(*timing)), (slow,), (late, *accept), family=family),
    }


def one(place: Place, name: str, draw: Callable[[Generator, Seen], laws.PortLaw], accept: tuple[str, ...],
        near: tuple[str, ...] = (), *, also: tuple[Pair, ...] = (), outside: bool = False) -> dict[str, Entry]:  # fmt: skip
    """A law at a place. `also`: right answers elsewhere."""
    return {
        f"{place.name}_{name}": Entry(
            _at(place, draw), _pairs(place, *accept) + also, _pairs(place, *near), family=place.name, outside=outside
        )
    }
