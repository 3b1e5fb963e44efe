"""Which mechanisms can be attached where."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from greybox_torch.diagnosis.screen.further_curves import further_curves
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.mechanisms.actuator import InputDelay
from greybox_torch.mechanisms.attachment import Attachment, attach
from greybox_torch.mechanisms.end_stop import EndStop
from greybox_torch.mechanisms.gravity import Gravity
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.mechanism import Mechanism, Surroundings
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.mechanisms.transmission_error import TransmissionError
from greybox_torch.mechanisms.unknown import INPUT, Unknown
from greybox_torch.mechanisms.unknown_fading import UnknownFading
from greybox_torch.mechanisms.unknown_map import UnknownMap
from greybox_torch.mechanisms.unknown_play import UnknownPlay
from greybox_torch.mechanisms.unknown_rate_limit import UnknownRateLimit
from greybox_torch.mechanisms.unknown_with_memory import UnknownWithMemory
from greybox_torch.mechanisms.varying_friction import PositionDependentFriction
from greybox_torch.model import Balance, Body, Coupling, GreyBoxModel, Port
from greybox_torch.model.idle_inputs import ports_in_use
from greybox_torch.model.joined_bodies import joined_bodies, to_ground
from greybox_torch.model.ports import Actuator, Sensor, driving_body, integrates_position

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

SAME = 1e-9
"""Share of its largest magnitude within which an input is constant."""

MOST_KNOTS_FROM_ELSEWHERE = 20
"""How fine curves over signals of other ports may be, and those that multiply a rate: each knot costs the screen as much as a law."""


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
    for port in ports_in_use(model):
        shifted = shifts.get(port.name, "")
        if flexible and _gives_no_more_than_a_body(model, port, surroundings[port.name]):
            continue
        for mechanism in _curves(model, port, knots) if flexible else _laws_at(model, port):
            if port.kind in mechanism.kinds and _available(mechanism, surroundings[port.name]):
                law = mechanism if shifted or not mechanism.kinematic else mechanism.written_as_force()
                found += [] if law is None else [attach(model, port.name, law, shifted)]
    if not flexible:
        return [*found, *chain_candidates(model, surroundings), *common_delays(model)]
    coarse = knots <= MOST_KNOTS_FROM_ELSEWHERE
    further = further_curves(model, knots) if coarse else ()
    return [*found, *(attach(model, port.name, c) for port, c in further if c.available(surroundings[port.name]))]


def _gives_no_more_than_a_body(model: GreyBoxModel, port: Port, around: Surroundings) -> bool:
    """Whether a port is an actuator whose input is the same in all samples, of a model that has another port for a force.

    A gain of it that follows a signal is a force that does. Seen: a ball that falls, with g as its input, told as unknown at that (0.97).
    """
    if not isinstance(port, Actuator) or all(isinstance(q, Actuator | Sensor) for q in ports_in_use(model)):
        return False
    moves = around.ranges.get("input")
    return moves is not None and moves.high - moves.low <= SAME * moves.reach


def _laws() -> Iterable[Mechanism]:
    """Every law of the library, stops at both ends too: where a body goes from one to the other, neither alone holds it."""
    yield from (law() for law in LIBRARY.values())
    yield EndStop(both=True)


def _laws_at(model: GreyBoxModel, port: Port) -> Iterable[Mechanism]:
    """Every law, but no error of a gear between a body and what stands still: it is a force on the body that repeats along its travel."""
    return (law for law in _laws() if not isinstance(law, TransmissionError) or _is_gear(model, port))


def _is_gear(model: GreyBoxModel, port: Port) -> bool:
    """Whether a port is a coupling that holds no body to the ground, of a model with a driving body."""
    if not isinstance(port, Coupling) or driving_body(model.ports) is None:
        return False
    return not any(to_ground(model, port, body) for body in model.ports if isinstance(body, Body))


def chain_candidates(model: GreyBoxModel, surroundings: Mapping[str, Surroundings]) -> list[Attachment]:
    """The weight of a chain of links, where two bodies or more have an angle: one law that acts at all of their joints.

    Of bodies that a spring joins the last one is a link: they turn about the same axis.
    """
    with_angle = (b for *_, b in joined_bodies(model) if b.position is not None and _is_angle(surroundings[b.name]))
    links = [body.name for body in with_angle]
    return [attach(model, links[0], Gravity(links), label="_of_chain")] if len(links) > 1 else []


def common_delays(model: GreyBoxModel) -> list[Attachment]:
    """A dead time of all inputs together, where there are several: one computer or one bus drives them."""
    drives = [port for port in ports_in_use(model) if isinstance(port, Actuator)]
    if len(drives) < 2:
        return []
    late = InputDelay([port.input for port in drives[1:]])
    return [attach(model, drives[0].name, late, label="_of_all")]


def periodic_candidates(
    model: GreyBoxModel,
    shifts: Mapping[str, str],
    surroundings: Mapping[str, Surroundings],
    orders: Iterable[float],
    least_ripple_order: float = DiagnosisSettings().least_ripple_order,
    at: str | None = None,
) -> list[Attachment]:
    """Periodic mechanisms at every port that they fit, at the given orders (gravity, order one, stands by itself).

    Args:
        at: one body; then its ripple alone. Friction that repeats along another body's travel takes up, in part, what dry friction lacks:
            at the second joint of a real double pendulum it was told (0.85) beside the friction of the first.
    """
    found = []
    for order in orders:
        for port in model.ports if at is None else (p for p in model.ports if p.name == at):
            if isinstance(port, Body):
                found += [attach(model, port.name, PositionDependentFriction(order))] if at is None else []
                if order > least_ripple_order or not _is_angle(surroundings[port.name]):
                    found.append(attach(model, port.name, TorqueRipple(order)))
            elif _is_gear(model, port):
                shifted, error = shifts.get(port.name, ""), TransmissionError(order)
                found.append(attach(model, port.name, error if shifted else error.written_as_force(), shifted))
    return found


def _curves(model: GreyBoxModel, port: Port, knots: int) -> Iterable[Unknown]:
    yield from (Unknown(signal, knots) for signal in FLEXIBLE.get(port.kind, ()))
    for signal, factor in GAINS.get(port.kind, ()):
        if signal != "position" or not integrates_position(model.ports, port):
            yield Unknown(signal, knots, factor)
    if isinstance(port, Body) and port.position is not None and len(model.inputs) > 1:
        # One input's gain over the position is a curve at its actuator. Of several, one may be no drive: a flow, a pressure, a load.
        yield from (Unknown("position", knots, f"{INPUT}{one.name}") for one in model.inputs)
    if isinstance(port, Balance) and len(model.inputs) > 1:
        # Either way round: what an input does to a rate by which a level falls, and what a level does to what an input brings.
        yield from (Unknown("level", knots, f"{INPUT}{one.name}") for one in model.inputs)
        yield from (Unknown(f"{INPUT}{one.name}", knots, "level") for one in model.inputs)


def memory_candidates(
    model: GreyBoxModel, surroundings: Mapping[str, Surroundings], knots: int = 0
) -> list[Attachment]:
    """Residuals with one and two hidden states at every port, of each signal that free curves are tried over, and gains that fade with
    that signal; at actuators play, a limit of the rate, and a map over input and speed.

    With ``knots``, those of one state with a curve in front.

    Not of a position that would have to be integrated from the speed: what it begins at would not be known. Nor at sensors, whose memory
    has names: lags and delays.
    """
    found = []
    for port in (q for q in ports_in_use(model) if q.kind in UnknownWithMemory.kinds):
        for signal in FLEXIBLE.get(port.kind, ()):
            if signal in surroundings[port.name].ranges and not (
                signal == "position" and integrates_position(model.ports, port)
            ):
                plain = [make(signal, n) for make in (UnknownWithMemory, UnknownFading) for n in (1, 2)]
                kinds = [UnknownWithMemory(signal, 1, knots)] if knots else plain
                found += [attach(model, port.name, mechanism) for mechanism in kinds]
        if isinstance(port, Actuator) and not knots:
            own = (make() for make in (UnknownPlay, UnknownRateLimit, UnknownMap))
            found += [attach(model, port.name, one) for one in own if one.available(surroundings[port.name])]
    return found


def _is_angle(around: Surroundings) -> bool:
    return around.units.get("position", "").startswith(ANGLES) or not around.units.get("position", "")


def _available(mechanism: Mechanism, around: Surroundings) -> bool:
    if isinstance(mechanism, Gravity | PositionDependentFriction | TorqueRipple) and not _is_angle(around):
        return False  # as the library offers them they repeat once per turn; periodic_candidates has those with other periods
    return mechanism.available(around)
