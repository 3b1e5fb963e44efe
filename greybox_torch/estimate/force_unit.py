"""The unit of the force at a port, as far as the declared units say."""

from __future__ import annotations

from collections.abc import Mapping

from greybox_torch.data.units import bare
from greybox_torch.model import Balance, Body, GreyBoxModel, Port
from greybox_torch.model.own_rate import added_to, divided_by
from greybox_torch.model.ports import Actuator, Sensor
from greybox_torch.model.unit_of_rate import unit_of_rate

_PER_SECOND = {"J": "W", "kJ": "kW", "MJ": "MW", "Ws": "W", "As": "A", "C": "A"}
"""What a store that has so much of it for each unit of its level takes in, where that has a name of its own; keys are bare."""

_TIMES = {("m", "m^2"): "m^3/s", ("V", "F"): "A", ("V", "As/V"): "A"}
"""By the units of a level and of what its rate is multiplied by, bare."""

_MOVED = {"rad": "N m", "m": "N"}
"""The force by the unit of what it moves, where equations of motion divide it by an inertia in units of the SI."""

_INERTIAS = {("mm", "kg"): "mN", ("m", "g"): "mN", ("mm", "g"): "µN"}
"""The force by that unit and by that of the one parameter that it is divided by, bare, where these are other units."""

_TEMPERATURES = {"K", "degC", "C"}


def force_unit(model: GreyBoxModel, port: Port, units: Mapping[str, str]) -> str:
    """The unit of the force at a port, by the ``units`` of its signals; empty where it is not known."""
    if isinstance(port, Actuator):
        return units["input"]
    if isinstance(port, Sensor):
        return units["output"]
    if isinstance(port, Balance):
        return _of_balance(model, port, units.get("level", ""))
    if state := added_to(model, port):  # the equation is one of accelerations
        return unit_of_rate(next(s.unit for s in model.states if s.name == state))
    place = units.get("position" if isinstance(port, Body) else "deflection", "")
    inertia = divided_by(model, port)
    return _INERTIAS.get((bare(place), bare(inertia.unit) if inertia else ""), _MOVED.get(place, ""))


def _of_balance(model: GreyBoxModel, port: Balance, level: str) -> str:
    """That of the level's rate, or where the port's force is divided by a capacity what that stores, per second."""
    if not level:
        return ""
    capacity = divided_by(model, port)
    if capacity is None:
        return f"{level}/s" if added_to(model, port) else ""
    if (bare(level), bare(capacity.unit)) in _TIMES:
        return _TIMES[bare(level), bare(capacity.unit)]
    stored, _, per = (part.strip() for part in capacity.unit.rpartition("/"))
    if not stored or (bare(per) != bare(level) and not {bare(per), bare(level)} <= _TEMPERATURES):
        return ""
    return _PER_SECOND.get(bare(stored), f"{stored}/s")
