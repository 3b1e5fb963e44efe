"""How fast a level changes by the model's own equations, and what a force at its port has for a unit."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.surroundings import surroundings_along
from greybox_torch.model import Balance, Body, Coupling, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.model.own_rate import added_to, divided_by


class Room(GreyBoxModel):
    """A room whose port takes watts, and a tank whose port takes metres per second."""

    states: ClassVar = [State("air", "K"), State("water", "m")]
    inputs: ClassVar = [Input("heat", "W")]
    outputs: ClassVar = [Output("air", "K")]
    parameters: ClassVar = [Parameter("C", 500.0, unit="J/K")]
    ports: ClassVar = [
        Balance("room", level="air"),
        Balance("tank", level="water"),
        Balance("mean", level=lambda x, u, p: 0.5 * x.air),
    ]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"air": (u.heat + port.room) / p.C, "water": port.tank - 0.1 * x.water}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"air": x.air}


@pytest.mark.parametrize(("port", "adds", "unit"), [("room", False, "W"), ("tank", True, "m/s"), ("mean", False, "")])
def test_a_force_at_a_balance_has_the_unit_of_the_rate_where_it_adds_to_it(port: str, adds: bool, unit: str) -> None:
    """Seen: heights of a curve of watts, told in K/s."""
    model = Room()
    assert (added_to(model, next(q for q in model.ports if q.name == port)) is not None) == adds
    recording = gt.Recording.from_arrays("run", {"heat": np.ones(20), "air": np.ones(20)}, sample_time=1.0)
    problem = make_problem(gt.DataSet([recording]), model, (recording,))
    around = surroundings_along(model, problem, np.ones((problem.records.u.shape[1], 2)))
    assert around[port].force_unit == unit


@pytest.mark.parametrize(
    ("level", "unit", "force"),
    [
        ("degC", "J/K", "W"),
        ("K", "kJ/K", "kW"),
        ("m", "m^2", "m^3/s"),
        ("m", "m²", "m^3/s"),
        ("m", "m2", "m^3/s"),
        ("V", "A·s/V", "A"),
        ("bar", "m³ / bar", "m³/s"),
        ("°C", "W·s/K", "W"),
        ("bar", "m^3/bar", "m^3/s"),
        ("m", "kg/K", ""),
        ("m", "", ""),
    ],
)
def test_a_force_divided_by_a_capacity_has_the_unit_of_what_that_stores_per_second(
    level: str, unit: str, force: str
) -> None:
    """Seen: the axis of a curve of watts without a unit. A capacity of one is a capacity all the same."""

    class Store(Room):
        states: ClassVar = [State("air", level), State("water", "m")]
        parameters: ClassVar = [Parameter("C", 1.0, unit=unit)]

    model = Store()
    recording = gt.Recording.from_arrays("run", {"heat": np.ones(20), "air": np.ones(20)}, sample_time=1.0)
    problem = make_problem(gt.DataSet([recording]), model, (recording,))
    around = surroundings_along(model, problem, np.ones((problem.records.u.shape[1], 2)))
    assert around["room"].force_unit == force


@pytest.mark.parametrize(
    ("level", "unit", "factor", "force"),
    [
        ("mm", "m^2", 1000.0, "m^3/s"),
        ("mm", "m^2", 1.0, ""),
        ("m", "m^2", 1000.0, ""),
        ("bar", "m^3/Pa", 1e-5, "m^3/s"),
        ("cm", "m^2", 100.0, "m^3/s"),
    ],
)
def test_a_rate_in_another_unit_than_the_model_reckons_in(level: str, unit: str, factor: float, force: str) -> None:
    """Seen: a level in mm and flows in m^3/s; the flow of an overflow had no unit, in the table and on the axis."""

    class Tank(Room):
        states: ClassVar = [State("air", level), State("water", "m")]
        parameters: ClassVar = [Parameter("A", 0.12, unit=unit)]

        def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
            return {"air": factor * (u.heat + port.room) / p.A, "water": port.tank - 0.1 * x.water}

    model = Tank()
    recording = gt.Recording.from_arrays("run", {"heat": np.ones(20), "air": np.ones(20)}, sample_time=1.0)
    problem = make_problem(gt.DataSet([recording]), model, (recording,))
    around = surroundings_along(model, problem, np.ones((problem.records.u.shape[1], 2)))
    assert around["room"].force_unit == force


def test_a_force_divided_by_more_than_one_parameter_is_divided_by_none_of_them() -> None:
    class Block(Room):
        parameters: ClassVar = [Parameter("C", 500.0, unit="J/(kg K)"), Parameter("m", 1.0, unit="kg")]

        def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
            return {"air": (u.heat + port.room) / (p.m * p.C), "water": port.tank - 0.1 * x.water}

    room, port = Room(), Room.ports[0]
    found = divided_by(room, port)
    assert found is not None and found.name == "C"
    assert divided_by(Block(), port) is None and divided_by(room, Room.ports[1]) is None


def test_a_parameter_of_minus_one_is_changed_as_well() -> None:
    """Seen by reading: twice minus one and one more is minus one, so that what acts was taken for what does not."""

    class Turned(Room):
        parameters: ClassVar = [Parameter("C", 500.0, unit="J/K"), Parameter("sign", -1.0)]

        def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
            return {"air": (u.heat + port.room) / (p.C * p.sign**2), "water": port.tank - 0.1 * x.water}

    assert divided_by(Turned(), Room.ports[0]) is None


@pytest.mark.parametrize(
    ("place", "inertia", "powers", "force", "per"),
    [
        ("rad", "", 0, "rad/s^2", ("1/s", "1/s^2")),
        ("mm", "", 0, "mm/s^2", ("1/s", "1/s^2")),
        ("rad", "kg m^2", 1, "N m", ("N m/(rad/s)", "N m/(rad)")),
        ("m", "kg", 1, "N", ("N/(m/s)", "N/(m)")),
        ("mm", "kg", 1, "mN", ("mN/(mm/s)", "mN/(mm)")),
        ("rad", "m", 2, "N m", ("N m/(rad/s)", "N m/(rad)")),
        ("deg", "kg m^2", 1, "", ("", "")),
    ],
)
def test_a_force_on_a_body_has_the_unit_of_what_it_changes(
    place: str, inertia: str, powers: int, force: str, per: tuple[str, str]
) -> None:
    """Seen: gravity of 72 "N m" in equations of rad/s^2, and the stiffness of a stop in "/(mm)". An inertia of one is one all the same."""

    class Mass(GreyBoxModel):
        states: ClassVar = [State("place", place), State("speed", f"{place}/s")]
        inputs: ClassVar = [Input("push", "V")]
        outputs: ClassVar = [Output("place", place)]
        parameters: ClassVar = [Parameter("J", 1.0, unit=inertia)]
        ports: ClassVar = [
            Body("mass", speed="speed", position="place"),
            Coupling("spring", deflection=lambda x, u, p: x.place, rate=lambda x, u, p: x.speed),
        ]

        def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
            return {"place": x.speed, "speed": (u.push + port.mass - port.spring) / p.J**powers}

        def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
            return {"place": x.place}

    recording = gt.Recording.from_arrays("run", {"push": np.ones(20), "place": np.ones(20)}, sample_time=1.0)
    problem = make_problem(gt.DataSet([recording]), Mass(), (recording,))
    around = surroundings_along(Mass(), problem, np.ones((20, 2)))
    assert (around["mass"].force_unit, around["mass"].per("speed"), around["mass"].per("position")) == (force, *per)
    assert around["spring"].force_unit == ("" if place == "mm" and inertia else force)
