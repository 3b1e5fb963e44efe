"""Signals of a port by the model's own names of them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from greybox_torch.diagnosis.effect import Curve
from greybox_torch.mechanisms.added_declarations import position_unit
from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.mechanisms.unknown import INPUT
from greybox_torch.model import Coupling, GreyBoxModel
from greybox_torch.model.along_motion import ALONG, DIRECTION
from greybox_torch.model.own_rate import RATE, balanced_state
from greybox_torch.model.ports import Actuator, Port, driving_body
from greybox_torch.model.signals_elsewhere import ABOVE, DIFFERENCE
from greybox_torch.model.states_at_no_port import STATE
from greybox_torch.model.within_turn import TURN, TURN_OF


def as_named(curve: Curve | None, model: GreyBoxModel, site: Port, own: tuple[str, ...] = ()) -> Curve | None:
    """A curve over a turn or a signal of another port by the model's own name of it; own signals keep their names at a port. What
    multiplies it goes by the model's name.

    Args:
        own: the signal that the effect's first name stands for, which "load", "deflection" and "position" may be beside.
    """
    if curve is None:
        return None
    another = curve.signal in ("load", "deflection", "position") and curve.signal not in own
    if curve.factor is not None:
        factor = replace(curve.factor, signal=signal_name(model, site, curve.factor.signal))
        curve = replace(curve, factor=factor)
    named = curve.signal == TURN or "@" in curve.signal or another
    return replace(curve, signal=signal_name(model, site, curve.signal)) if named else curve


def unit_at(around: Surroundings, signal: str) -> str:
    """The unit of a signal at a port; what a body carries has that of the forces there, and a delayed input that of the input."""
    signal = "input" if signal == "delayed" else signal
    return around.units.get(signal, around.force_unit if signal == "load" and "speed" in around.units else "")


def unit_told(model: GreyBoxModel, site: Port, around: Surroundings, signal: str) -> str:
    """The unit of a port's signal; at a coupling its position is that of the driving body."""
    unit = unit_at(around, signal)
    return _unit_of_position(model, site) if signal == "position" and not unit else unit


def _unit_of_position(model: GreyBoxModel, site: Port) -> str:
    body = driving_body(model.all_ports)
    return position_unit(model, body) if isinstance(site, Coupling) and body is not None else ""


def signal_name(model: GreyBoxModel, site: Port, signal: str) -> str:
    """The model's own name of a port's signal, where it has one."""
    given: Any = site.signals.get(signal)
    if isinstance(given, str):
        return given
    if signal in ("input", "output"):
        return str(getattr(site, signal, signal))
    if signal == "delayed":
        return f"delayed {signal_name(model, site, 'input')}"
    if signal.startswith((INPUT, STATE)):
        return signal.partition("@")[2]
    if signal.startswith(DIFFERENCE):
        other = next(q for q in model.all_ports if q.name == signal.removeprefix(DIFFERENCE))
        return f"{signal_name(model, site, 'level')} - {signal_name(model, other, 'level')}"
    if signal.startswith(ABOVE):
        return f"{signal_name(model, site, 'level')} - {signal.removeprefix(ABOVE)}"
    if signal.startswith(TURN_OF):
        return signal_name(model, next(q for q in model.all_ports if q.name == signal.removeprefix(TURN_OF)), TURN)
    if signal == TURN:
        return f"{signal_name(model, site, 'position')} within a turn"
    if signal.startswith(ALONG):
        return f"{signal.removeprefix(ALONG)} along the motion"
    if signal.startswith(DIRECTION):
        return f"direction of {signal_name(model, site, 'speed')}"
    if signal.startswith(RATE):
        return f"d {balanced_state(model, site)}/dt"
    if "@" in signal:
        kind, _, elsewhere = signal.partition("@")
        return signal_name(model, next(q for q in model.all_ports if q.name == elsewhere), kind)
    body = driving_body(model.all_ports)
    if signal in ("speed", "position") and isinstance(site, Actuator | Coupling) and body is not None:
        return signal_name(model, body, signal)
    return signal if signal == "time" else f"{site.name}.{signal}"
