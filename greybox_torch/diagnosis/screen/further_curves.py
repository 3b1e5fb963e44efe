"""Curves over other signals than the few of their own port: its rate and direction, what is elsewhere, what an input does there."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import chain, islice, zip_longest
from typing import Any

import torch

from greybox_torch.diagnosis.screen.curves_by_states import curves_by_states
from greybox_torch.mechanisms.unknown import INPUT, Unknown
from greybox_torch.model import Balance, Body, Coupling, GreyBoxModel, Port
from greybox_torch.model.along_motion import ALONG, DIRECTION, inputs_that_push
from greybox_torch.model.exchanges import exchange_between
from greybox_torch.model.idle_inputs import idle_inputs, ports_in_use
from greybox_torch.model.joined_bodies import bodies_apart
from greybox_torch.model.once_per_model import once_per_model
from greybox_torch.model.own_rate import RATE, balanced_state, without_laws
from greybox_torch.model.ports import Actuator, integrates_position
from greybox_torch.model.random_points import random_points
from greybox_torch.model.signals_elsewhere import (
    ABOVE,
    DIFFERENCE,
    LEVEL,
    SPEED,
    balances_alike,
    inputs_alike,
    positions_elsewhere,
    signals_elsewhere,
    turning_elsewhere,
)
from greybox_torch.model.states_at_no_port import STATE
from greybox_torch.model.states_of import inputs_of
from greybox_torch.model.within_turn import TURN

MOST_FROM_ELSEWHERE, MOST_FROM_INPUTS, MOST_EXCHANGED, MOST_LOST = 40, 12, 12, 12
"""Curves of signals of other ports, of inputs, of what balances exchange, and of what they lose, that are tried at all."""


def further_curves(model: GreyBoxModel, knots: int) -> Iterable[tuple[Port, Unknown]]:
    """All of them, with the port of each."""
    ways = (
        _by_rate,
        _by_direction,
        _from_elsewhere,
        _from_inputs,
        _stiffness,
        _within_a_turn,
        _exchanged,
        _lost,
        curves_by_states,
    )
    return chain.from_iterable(way(model, knots) for way in ways)


def _by_rate(model: GreyBoxModel, knots: int) -> Iterable[tuple[Port, Unknown]]:
    """An inertia over the position, a capacity over the level: a crank, a store that melts, a coil whose iron saturates."""
    for port in (q for q in model.ports if balanced_state(model, q)):
        own = (
            ("level",)
            if isinstance(port, Balance)
            else ()
            if integrates_position(model.ports, port)
            else ("position", TURN)
        )
        yield from ((port, Unknown(signal, knots, f"{RATE}{port.name}")) for signal in own)


def _by_direction(model: GreyBoxModel, knots: int) -> Iterable[tuple[Port, Unknown]]:
    """Dry friction that varies with an input, by whether that drives or brakes (a worm gear), or with the position (a worn rail)."""
    for body in (q for q in model.ports if isinstance(q, Body)):
        signals = [f"{ALONG}{name}" for name in inputs_that_push(model)[body.name]]
        signals += [] if integrates_position(model.ports, body) else ["position"]
        yield from ((body, Unknown(signal, knots, f"{DIRECTION}{body.name}")) for signal in signals)


def _from_elsewhere(model: GreyBoxModel, knots: int) -> Iterable[tuple[Port, Unknown]]:
    """What another part of the machine does to a port by where it stands: by itself, or to what an input, the body's speed or position or
    the level does there. What it does by how fast it is (the air that a turning rotor drags along) it does by itself, to a stiffness (of
    what is thrown outwards), or to what resists the speed (the water at a hull that turns on its way). At an actuator a level changes the
    gain (a pump's, that works against a tank).

    No more than ``MOST_FROM_ELSEWHERE``, which the ports take in turn.
    """
    inputs = [f"{INPUT}{one.name}" for one in model.inputs]

    def of(port: Port) -> Iterator[tuple[Port, Unknown]]:
        for signal in (n for n in signals_elsewhere(model, port) if not n.startswith((DIFFERENCE, ABOVE, STATE))):
            own = (*(_own(port) if signal.startswith(LEVEL) else ()), *stiff(port))
            own += ("speed",) if signal.startswith(SPEED) else ()
            factors = ("", *own) if signal.startswith(SPEED) else ("", *inputs, *own)
            rate = (f"{RATE}{port.name}",) if not signal.startswith(SPEED) and balanced_state(model, port) else ()
            yield from ((port, Unknown(signal, knots, factor)) for factor in (*factors, *rate))
            if signal.startswith(LEVEL) and stiff(
                port
            ):  # a thrust near the ground, the current of a coil that leaves its gap
                yield port, Unknown("position", knots, signal)

    def stiff(port: Port) -> tuple[str, ...]:
        return ("position",) if isinstance(port, Body) and not integrates_position(model.ports, port) else ()

    def at(actuator: Actuator) -> Iterator[tuple[Port, Unknown]]:
        yield from ((actuator, Unknown(level, knots, "input")) for level in signals_elsewhere(model, actuator))

    actuators = (q for q in ports_in_use(model) if isinstance(q, Actuator))
    others = (port for port in model.ports if not isinstance(port, Coupling))
    return _in_turn((*map(of, others), *map(at, actuators)), MOST_FROM_ELSEWHERE)


def _stiffness(model: GreyBoxModel, knots: int) -> Iterable[tuple[Port, Unknown]]:
    """A coupling's stiffness by where a body stands: the free length of a belt, a rope or a screw."""
    for port in (q for q in model.ports if isinstance(q, Coupling)):
        yield from ((port, Unknown(signal, knots, "deflection")) for signal in positions_elsewhere(model, port))


def _own(port: Port) -> tuple[str, ...]:
    """What a level elsewhere may change the effect of: friction with a temperature, viscous or dry, a rate of reaction or a resistance with
    a temperature or a charge.
    """
    return ("speed", f"{DIRECTION}{port.name}") if isinstance(port, Body) else ("level",)


def _from_inputs(model: GreyBoxModel, knots: int) -> Iterable[tuple[Port, Unknown]]:
    """What an input does to a level or a speed on which it does not act in the model (a rudder that heels the ship), or to a level on which
    it acts in proportion to a state alone (the heat that a current makes beside what it pumps). No more than ``MOST_FROM_INPUTS``.

    An input in proportion alone is told at its actuator. A body that a spring joins with one that is pushed has no part of that push.
    """

    inputs = _acting_otherwise(model)
    ports = (port for port in model.ports if port.name in inputs)
    ways = ([(port, Unknown(f"{INPUT}{name}", knots)) for name in inputs[port.name]] for port in ports)
    return _in_turn(ways, MOST_FROM_INPUTS)


@once_per_model
def _acting_otherwise(model: GreyBoxModel) -> dict[str, list[str]]:
    """By body and balance the inputs that :func:`_from_inputs` tells of."""
    found = {}
    for port in (q for q in model.ports if balanced_state(model, q)):
        rate = without_laws(model, port)
        acting = _acting_near(model, port) if isinstance(port, Body) else inputs_of(model, rate)
        by_a_state = (n for n in acting if isinstance(port, Balance) and _by_a_state(model, n, rate))
        offered = {one.name for one in model.inputs}.difference(acting).union(by_a_state)
        found[port.name] = [one.name for one in model.inputs if one.name in offered]
    return found


def _acting_near(model: GreyBoxModel, body: Body) -> set[str]:
    """The inputs that push a body or one that springs join with it."""
    pushing, apart = inputs_that_push(model), {other.name for other in bodies_apart(model, body)}
    return {name for other, names in pushing.items() if other not in apart for name in names}


def _by_a_state(model: GreyBoxModel, name: str, rate: Callable[[Any, Any, Any], Any]) -> bool:
    """Whether what an input contributes to a rate depends on a state."""
    *points, p = random_points(model)
    x, u = model.named_signals(*points)
    without = u.replaced(**{name: 0.0 * u[name]})
    here, *moved = (rate(at, u, p) - rate(at, without, p) for at in (x, *(x.replaced(**{n: x[n] + 1.0}) for n in x)))
    return any(not torch.allclose(torch.as_tensor(there), torch.as_tensor(here), rtol=1e-4) for there in moved)


def _within_a_turn(model: GreyBoxModel, knots: int) -> Iterable[tuple[Port, Unknown]]:
    """What a turning body does to a balance by its angle, by itself or to what it does by its speed: what a pump delivers pulsates."""
    for port in model.ports:
        for signal, body in turning_elsewhere(model, port).items():
            yield from ((port, Unknown(signal, knots, factor)) for factor in ("", f"{SPEED}{body.name}"))


def _exchanged(model: GreyBoxModel, knots: int) -> Iterable[tuple[Port, Unknown]]:
    """What two balances exchange: by how far their levels are apart, and in proportion to that, by what may change the coefficient: an
    input (a heat exchanger's flow), or either level. No more than ``MOST_EXCHANGED``.

    Where the model has a balance for that exchange, there: its own level is how far they are apart. Seen: the flow's effect on the heat
    that goes through plates, told at the hot side.
    """
    inputs = [f"{INPUT}{one.name}" for one in model.inputs]

    def between(port: Balance, other: Balance) -> Iterator[tuple[Port, Unknown]]:
        there, apart = exchange_between(model, port, other), f"{DIFFERENCE}{other.name}"
        if there is not None:
            yield from ((there, Unknown(one, knots, "level")) for one in inputs)
            yield from ((there, Unknown(f"{LEVEL}{one.name}", knots, "level")) for one in (port, other))
            return
        yield port, Unknown(apart, knots)
        yield from ((port, Unknown(one, knots, apart)) for one in (*inputs, "level", f"{LEVEL}{other.name}"))

    balances = [q for q in model.ports if isinstance(q, Balance)]
    pairs = [(q, other) for q in balances for other in balances_alike(model, q)]
    each_once = (between(q, other) for q, other in pairs if balances.index(q) < balances.index(other))
    return _in_turn(each_once, MOST_EXCHANGED)


def _lost(model: GreyBoxModel, knots: int) -> Iterable[tuple[Port, Unknown]]:
    """What a balance loses to its surroundings: by how far its level is above an input of its unit, and in proportion to that, by another
    input (the wind, a fan), those first that the model does not use. No more than ``MOST_LOST``.
    """
    inputs = sorted((one.name for one in model.inputs), key=lambda name: name not in idle_inputs(model))

    def to(port: Balance, name: str) -> Iterator[tuple[Port, Unknown]]:
        apart, alike = f"{ABOVE}{name}", inputs_alike(model, port)
        yield port, Unknown(apart, knots)
        yield from ((port, Unknown(f"{INPUT}{one}", knots, apart)) for one in inputs if one not in alike)

    balances = [q for q in model.ports if isinstance(q, Balance)]
    return _in_turn([to(q, name) for q in balances for name in inputs_alike(model, q)], MOST_LOST)


def _in_turn(ways: Iterable[Iterable[tuple[Port, Unknown]]], most: int) -> Iterator[tuple[Port, Unknown]]:
    """The first few curves, which ports (or pairs of them) take in turn."""
    return islice((way for turn in zip_longest(*ways) for way in turn if way is not None), most)
