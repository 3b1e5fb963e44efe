"""What another part of a machine may do to a port by where that part stands, or how fast it is: other axes and balances."""

from __future__ import annotations

from collections.abc import Iterable

from greybox_torch.model.greybox_model import GreyBoxModel
from greybox_torch.model.joined_bodies import bodies_apart
from greybox_torch.model.ports import Actuator, Balance, Body, Coupling, Port, Sensor, Signal, driving_body, value_of
from greybox_torch.model.states_at_no_port import STATE, driving_states, states_shown
from greybox_torch.model.within_turn import TURN_OF

LEVEL, POSITION, SPEED = "level@", "position@", "speed@"
"""Beginnings of the names of such signals; the name of their port follows."""

DIFFERENCE = "difference@"
"""That of a balance's level less another one's, which drives what the two exchange."""


ABOVE = "above@"
"""That of a balance's level less an input of the same unit, which drives what it loses to the surroundings."""


def signals_elsewhere(model: GreyBoxModel, port: Port) -> dict[str, Signal]:
    """By name, at a body the positions and speeds of other axes, the levels of balances and the states that drive it, at a sensor the
    states that it shows, at a coupling the positions of bodies, at an actuator the levels of balances, at a balance those of others, by how
    much its own is above them, and above inputs that have its unit.

    A force by the speed of what a spring joins with a body is friction there, or the spring's damping.
    """
    found: dict[str, Signal] = {}
    if isinstance(port, Body | Coupling):
        there = positions_elsewhere(model, port).items()
        found |= {name: body.position for name, body in there if body.position is not None}
    if isinstance(port, Actuator | Body | Balance):
        balances = (q for q in model.ports if isinstance(q, Balance) and q.name != port.name)
        found |= {f"{LEVEL}{q.name}": q.level for q in balances}
    if isinstance(port, Body):
        found |= {f"{SPEED}{b.name}": b.speed for b in bodies_apart(model, port)}
        found |= {f"{STATE}{name}": name for name in driving_states(model, port)}
    if isinstance(port, Sensor):
        found |= {f"{STATE}{name}": name for name in states_shown(model, port)}
    if isinstance(port, Balance):
        found |= {f"{DIFFERENCE}{other.name}": difference(port, other) for other in balances_alike(model, port)}
        found |= {f"{ABOVE}{name}": above(port, name) for name in inputs_alike(model, port)}
    return found


def difference(balance: Balance, other: Balance) -> Signal:
    """The level of a balance less that of another."""
    return lambda x, u, p: value_of(balance.level, x, u, p) - value_of(other.level, x, u, p)


def above(balance: Balance, name: str) -> Signal:
    """The level of a balance less an input."""
    return lambda x, u, p: value_of(balance.level, x, u, p) - u[name]


def balances_alike(model: GreyBoxModel, balance: Balance) -> list[Balance]:
    """The other balances whose levels are states of the same unit."""
    others = (q for q in model.ports if isinstance(q, Balance) and q.name != balance.name)
    own = _unit_of_level(model, balance)
    return [q for q in others if own is not None and _unit_of_level(model, q) == own]


def inputs_alike(model: GreyBoxModel, balance: Balance) -> list[str]:
    """The inputs of the unit of a balance's level, where that is a state that has one: temperatures around what is warm."""
    own = _unit_of_level(model, balance)
    return [one.name for one in model.inputs if own and one.unit == own]


def _unit_of_level(model: GreyBoxModel, balance: Balance) -> str | None:
    """The unit of a level; None where it is no state."""
    return next((s.unit for s in model.states if s.name == balance.level), None)


def positions_elsewhere(model: GreyBoxModel, port: Body | Coupling) -> dict[str, Body]:
    """By the name of their position as a signal, the bodies apart from one (:func:`bodies_apart`), or for a coupling all but the driving
    body, whose positions recordings show.

    Not where nothing depends on a position: where it begins is then not known.
    """
    if isinstance(port, Body):
        there = bodies_apart(model, port)
    else:
        there = [b for b in model.ports if isinstance(b, Body) and b is not driving_body(model.ports)]
    return _whose_position_shows(model, there, POSITION)


def turning_elsewhere(model: GreyBoxModel, port: Port) -> dict[str, Body]:
    """For a balance, by the name of the body's angle within its turn as a signal, the bodies whose positions recordings show."""
    if not isinstance(port, Balance):
        return {}
    return _whose_position_shows(model, (q for q in model.ports if isinstance(q, Body)), TURN_OF)


def _whose_position_shows(model: GreyBoxModel, bodies: Iterable[Body], beginning: str) -> dict[str, Body]:
    """By the name of a signal that begins so, those of some bodies whose positions recordings show."""
    kept = model.carried_states()
    return {f"{beginning}{b.name}": b for b in bodies if b.position is not None and b.position not in kept}
