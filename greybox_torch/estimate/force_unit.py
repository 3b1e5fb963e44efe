"""The unit of the force at a port, as far as the declared units say."""

from __future__ import annotations

import math
from collections.abc import Mapping

from greybox_torch.data.units import bare
from greybox_torch.model import Balance, Body, GreyBoxModel, Parameter, Port
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

_RECKONED_IN = {
    "mm": (1e3, "m"),
    "cm": (1e2, "m"),
    "dm": (1e1, "m"),
    "kPa": (1e-3, "Pa"),
    "MPa": (1e-6, "Pa"),
    "mbar": (1e-2, "Pa"),
    "bar": (1e-5, "Pa"),
    "deg": (180.0 / math.pi, "rad"),
}
"""By the unit of a level or a position, bare: a factor on its rate by which the model reckons in another unit, and which that is."""

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
    place, inertia = _divided(model, port, place)
    return _INERTIAS.get((bare(place), bare(inertia.unit) if inertia else ""), _MOVED.get(place, ""))


def _of_balance(model: GreyBoxModel, port: Balance, level: str) -> str:
    """That of the level's rate, or where the port's force is divided by a capacity what that stores, per second."""
    if not level:
        return ""
    reckoned, capacity = _divided(model, port, level)
    if capacity is None:
        return f"{level}/s" if added_to(model, port) else ""
    level = reckoned
    if (bare(level), bare(capacity.unit)) in _TIMES:
        return _TIMES[bare(level), bare(capacity.unit)]
    stored, _, per = (part.strip() for part in capacity.unit.rpartition("/"))
    if not stored or (bare(per) != bare(level) and not {bare(per), bare(level)} <= _TEMPERATURES):
        return ""
    return _PER_SECOND.get(bare(stored), f"{stored}/s")


def _divided(model: GreyBoxModel, port: Port, unit: str) -> tuple[str, Parameter | None]:
    """The parameter by which a port's force is divided, if there is one, and the unit that it is then the change of: ``unit``, or where a
    factor stands before it the one that this makes of it.

    Seen: a level in mm, whose rate is 1000 (flow in m^3/s) / (area in m^2); the flow had no unit, and so no law's parameter had.
    """
    if (own := divided_by(model, port)) is not None or bare(unit) not in _RECKONED_IN:
        return unit, own
    factor, reckoned = _RECKONED_IN[bare(unit)]
    other = divided_by(model, port, factor)
    return (unit, None) if other is None else (reckoned, other)
