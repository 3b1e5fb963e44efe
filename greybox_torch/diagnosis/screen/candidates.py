"""Which mechanisms can be attached where."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import islice, zip_longest

from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.mechanisms.actuator import InputDelay
from greybox_torch.mechanisms.attachment import Attachment, attach
from greybox_torch.mechanisms.forces import TorqueRipple
from greybox_torch.mechanisms.gravity import Gravity
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.mechanism import Mechanism, Surroundings
from greybox_torch.mechanisms.transmission_error import TransmissionError
from greybox_torch.mechanisms.unknown import INPUT, Unknown
from greybox_torch.mechanisms.unknown_play import UnknownPlay
from greybox_torch.mechanisms.unknown_with_memory import UnknownWithMemory
from greybox_torch.mechanisms.varying_friction import PositionDependentFriction
from greybox_torch.model import Balance, Body, Coupling, GreyBoxModel, Port
from greybox_torch.model.along_motion import ALONG, DIRECTION, inputs_that_push
from greybox_torch.model.joined_bodies import joined_bodies
from greybox_torch.model.own_rate import RATE, balanced_state
from greybox_torch.model.ports import Actuator, driving_body
from greybox_torch.model.signals_elsewhere import DIFFERENCE, LEVEL, SPEED, balances_alike, signals_elsewhere
from greybox_torch.model.within_turn import TURN

ANGLES = ("rad", "deg", "rev", "turn")
"""Beginnings of the units of angles: only on an angle does gravity repeat."""

FLEXIBLE = {
    "body": ("speed", "position"),
    "coupling": ("deflection", "rate"),
    "balance": ("level",),
    "actuator": ("input",),
    "sensor": ("output",),
}
"""Signals that the flexible curve is tried over, by kind of port."""

GAINS = {
    "body": (("position", "speed"),),
    "actuator": (("time", "input"), ("speed", "input"), ("position", "input")),
    "coupling": (("speed", "rate"), ("position", "deflection")),
}
"""By kind of port, signals over which the gain of another may change: a battery that sags, a motor whose field weakens with its speed,
a voice coil that leaves its gap, a damper whose oil is torn along, a rope or a belt whose free length changes with where the load is, a
brake that acts over a part of the way.
"""

MOST_FROM_ELSEWHERE, MOST_EXCHANGED, MOST_KNOTS_FROM_ELSEWHERE = 24, 12, 20
"""Curves of signals of other ports, and of what balances exchange, that are tried at all, and how fine they, and those that multiply a
rate, may be: each knot costs the screen as much as a law.
"""


def candidates(
    model: GreyBoxModel,
    shifts: Mapping[str, str],
    surroundings: Mapping[str, Surroundings],
    *,
    flexible: bool,
    knots: int = SearchBudget().knots,
) -> list[Attachment]:
    """Every mechanism of the library at every port that it fits (or, with ``flexible``, the unknown curves).

    Args:
        shifts: by coupling, see :func:`shifted_states`.
        knots: of the unknown curves.
    """
    found = []
    for port in model.all_ports:
        shifted = shifts.get(port.name, "")
        for mechanism in _curves(model, port, knots) if flexible else (m() for m in LIBRARY.values()):
            if port.kind in mechanism.kinds and _available(mechanism, surroundings[port.name]):
                law = mechanism if shifted or not mechanism.kinematic else mechanism.written_as_force()
                found += [] if law is None else [attach(model, port.name, law, shifted)]
    if not flexible:
        return [*found, *chain_candidates(model, surroundings), *common_delays(model)]
    coarse = knots <= MOST_KNOTS_FROM_ELSEWHERE
    ways = (_by_rate, _by_direction, _from_elsewhere, _exchanged) if coarse else ()
    further = (one for way in ways for one in way(model, knots))
    return [*found, *(attach(model, port.name, c) for port, c in further if c.available(surroundings[port.name]))]


def chain_candidates(model: GreyBoxModel, surroundings: Mapping[str, Surroundings]) -> list[Attachment]:
    """The weight of a chain of links, where two bodies or more have an angle: one law that acts at all of their joints.

    Of bodies that a spring joins the last one is a link: they turn about the same axis.
    """
    with_angle = (b for *_, b in joined_bodies(model) if b.position is not None and _is_angle(surroundings[b.name]))
    links = [body.name for body in with_angle]
    return [attach(model, links[0], Gravity(links), label="_of_chain")] if len(links) > 1 else []


def common_delays(model: GreyBoxModel) -> list[Attachment]:
    """A dead time of all inputs together, where there are several: one computer or one bus drives them."""
    first, *rest = (port for port in model.all_ports if isinstance(port, Actuator))
    if not rest:
        return []
    late = InputDelay([port.input for port in rest])
    return [attach(model, first.name, late, label="_of_all")]


def periodic_candidates(
    model: GreyBoxModel,
    shifts: Mapping[str, str],
    surroundings: Mapping[str, Surroundings],
    orders: Iterable[float],
    least_ripple_order: float = DiagnosisSettings().least_ripple_order,
) -> list[Attachment]:
    """Periodic mechanisms at every port that they fit, at the given orders (gravity, order one, stands by itself)."""
    found = []
    for order in orders:
        for port in model.ports:
            if isinstance(port, Body):
                found.append(attach(model, port.name, PositionDependentFriction(order)))
                if order > least_ripple_order or not _is_angle(surroundings[port.name]):
                    found.append(attach(model, port.name, TorqueRipple(order)))
            elif isinstance(port, Coupling) and driving_body(model.ports) is not None:
                shifted = shifts.get(port.name, "")
                if shifted:
                    found.append(attach(model, port.name, TransmissionError(order), shifted))
    return found


def _curves(model: GreyBoxModel, port: Port, knots: int) -> Iterable[Unknown]:
    yield from (Unknown(signal, knots) for signal in FLEXIBLE.get(port.kind, ()))
    for signal, factor in GAINS.get(port.kind, ()):
        if signal != "position" or not _integrated(model, port):
            yield Unknown(signal, knots, factor)
    if isinstance(port, Body) and port.position is not None and len(model.inputs) > 1:
        # One input's gain over the position is a curve at its actuator. Of several, one may be no drive: a flow, a pressure, a load.
        yield from (Unknown("position", knots, f"{INPUT}{one.name}") for one in model.inputs)
    if isinstance(port, Balance) and len(model.inputs) > 1:
        yield from (Unknown("level", knots, f"{INPUT}{one.name}") for one in model.inputs)


def _by_rate(model: GreyBoxModel, knots: int) -> Iterable[tuple[Port, Unknown]]:
    """An inertia over the position, a capacity over the level: a crank, a store that melts, a coil whose iron saturates."""
    for port in (q for q in model.ports if balanced_state(model, q)):
        own = ("level",) if isinstance(port, Balance) else () if _integrated(model, port) else ("position", TURN)
        yield from ((port, Unknown(signal, knots, f"{RATE}{port.name}")) for signal in own)


def _by_direction(model: GreyBoxModel, knots: int) -> Iterable[tuple[Port, Unknown]]:
    """Dry friction that varies with an input, by whether that drives or brakes (a worm gear), or with the position (a worn rail)."""
    for body in (q for q in model.ports if isinstance(q, Body)):
        signals = [f"{ALONG}{name}" for name in inputs_that_push(model)[body.name]]
        signals += [] if _integrated(model, body) else ["position"]
        yield from ((body, Unknown(signal, knots, f"{DIRECTION}{body.name}")) for signal in signals)


def _from_elsewhere(model: GreyBoxModel, knots: int) -> Iterable[tuple[Port, Unknown]]:
    """What another part of the machine does to a port by where it stands: by itself, or to what an input, the body's speed or the level
    does there. What it does by how fast it is (the air that a turning rotor drags along) it does by itself. At an actuator a level changes
    the gain (a pump's, that works against a tank).

    No more than ``MOST_FROM_ELSEWHERE``, which the ports take in turn.
    """
    inputs = [f"{INPUT}{one.name}" for one in model.inputs]

    def of(port: Port) -> Iterator[tuple[Port, Unknown]]:
        for signal in (n for n in signals_elsewhere(model, port) if not n.startswith(DIFFERENCE)):
            own = _own(port) if signal.startswith(LEVEL) else ()
            factors = ("",) if signal.startswith(SPEED) else ("", *inputs, *own)
            rate = (f"{RATE}{port.name}",) if not signal.startswith(SPEED) and balanced_state(model, port) else ()
            yield from ((port, Unknown(signal, knots, factor)) for factor in (*factors, *rate))

    def at(actuator: Actuator) -> Iterator[tuple[Port, Unknown]]:
        yield from ((actuator, Unknown(level, knots, "input")) for level in signals_elsewhere(model, actuator))

    actuators = (q for q in model.all_ports if isinstance(q, Actuator))
    ways = (*map(of, model.ports), *map(at, actuators))
    in_turn = (way for turn in zip_longest(*ways) for way in turn if way is not None)
    return islice(in_turn, MOST_FROM_ELSEWHERE)


def _own(port: Port) -> tuple[str, ...]:
    """What a level elsewhere may change the effect of: friction with a temperature, viscous or dry, a rate of reaction or a resistance with
    a temperature or a charge.
    """
    return ("speed", f"{DIRECTION}{port.name}") if isinstance(port, Body) else ("level",)


def _exchanged(model: GreyBoxModel, knots: int) -> Iterable[tuple[Port, Unknown]]:
    """What two balances exchange: by how far their levels are apart, and in proportion to that, by what may change the coefficient: an
    input (a heat exchanger's flow), or either level. No more than ``MOST_EXCHANGED``.
    """
    inputs = [f"{INPUT}{one.name}" for one in model.inputs]

    def between(port: Balance, other: Balance) -> Iterator[tuple[Port, Unknown]]:
        apart = f"{DIFFERENCE}{other.name}"
        yield port, Unknown(apart, knots)
        yield from ((port, Unknown(one, knots, apart)) for one in (*inputs, "level", f"{LEVEL}{other.name}"))

    balances = [q for q in model.ports if isinstance(q, Balance)]
    pairs = [(q, other) for q in balances for other in balances_alike(model, q)]
    each_once = [between(q, other) for q, other in pairs if balances.index(q) < balances.index(other)]
    in_turn = (way for turn in zip_longest(*each_once) for way in turn if way is not None)
    return islice(in_turn, MOST_EXCHANGED)


def memory_candidates(
    model: GreyBoxModel, surroundings: Mapping[str, Surroundings], knots: int = 0
) -> list[Attachment]:
    """Residuals with one and two hidden states at every port, of each signal that free curves are tried over, and play at actuators.

    With ``knots``, those of one state with a curve in front.

    Not of a position that would have to be integrated from the speed: what it begins at would not be known. Nor at sensors, whose memory
    has names: lags and delays.
    """
    found = []
    for port in (q for q in model.all_ports if q.kind in UnknownWithMemory.kinds):
        for signal in FLEXIBLE.get(port.kind, ()):
            if signal in surroundings[port.name].ranges and not (signal == "position" and _integrated(model, port)):
                kinds = (
                    [UnknownWithMemory(signal, 1, knots)] if knots else [UnknownWithMemory(signal, m) for m in (1, 2)]
                )
                found += [attach(model, port.name, mechanism) for mechanism in kinds]
        if isinstance(port, Actuator) and not knots:
            found.append(attach(model, port.name, UnknownPlay()))
    return found


def _integrated(model: GreyBoxModel, port: Port) -> bool:
    """Whether the position at a port is none of the model's own, but has to be integrated from the speed of its body."""
    body = port if isinstance(port, Body) else driving_body(model.ports)
    return body is not None and body.position is None


def _is_angle(around: Surroundings) -> bool:
    return around.units.get("position", "").startswith(ANGLES) or not around.units.get("position", "")


def _available(mechanism: Mechanism, around: Surroundings) -> bool:
    if isinstance(mechanism, Gravity | PositionDependentFriction | TorqueRipple) and not _is_angle(around):
        return False  # as the library offers them they repeat once per turn; periodic_candidates has those with other periods
    return mechanism.available(around)
