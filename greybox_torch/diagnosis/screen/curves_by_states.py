"""Curves over states that no port has a signal for: what drives a body beyond a lag, and what a sensor shows beside others."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import islice

from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Body, GreyBoxModel, Port
from greybox_torch.model.ports import Sensor, integrates_position
from greybox_torch.model.states_at_no_port import STATE, driving_states, states_shown
from greybox_torch.model.states_of import states_of

MOST_BY_STATES = 16
"""Such curves that are tried at all."""


def curves_by_states(model: GreyBoxModel, knots: int) -> Iterable[tuple[Port, Unknown]]:
    """No more than ``MOST_BY_STATES``, with the port of each."""
    ways = (
        *(_driven(model, q, knots) for q in model.ports if isinstance(q, Body)),
        *(_shown(model, q, knots) for q in model.all_ports if isinstance(q, Sensor)),
    )
    return islice((one for way in ways for one in way), MOST_BY_STATES)


def _driven(model: GreyBoxModel, body: Body, knots: int) -> Iterator[tuple[Port, Unknown]]:
    """What a state that drives a body does to it: by itself (iron that saturates), and by where the body is or how fast (a coil that leaves
    its gap), which a curve at the actuator would do before the lag between.

    In place of such states the body's load, where they are in it. Seen: a voice coil's force by its stroke, told at the actuator with a
    sensor's lag.
    """
    driving = driving_states(model, body)
    in_load = set(driving) & (set() if body.load is None else states_of(model, body.load))
    for name in (*(("load",) if in_load else ()), *(f"{STATE}{s}" for s in driving if s not in in_load)):
        yield body, Unknown(name, knots)
        over = ("speed",) if integrates_position(model.ports, body) else ("position", "speed")
        yield from ((body, Unknown(signal, knots, name)) for signal in over)


def _shown(model: GreyBoxModel, sensor: Sensor, knots: int) -> Iterator[tuple[Port, Unknown]]:
    """How a sensor shows a state beside others, or beside an input: a battery's open-circuit voltage by its charge."""
    yield from ((sensor, Unknown(f"{STATE}{name}", knots)) for name in states_shown(model, sensor))
