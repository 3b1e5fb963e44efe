"""Which mechanism is offered at which port."""

from __future__ import annotations

import sys
from collections import defaultdict
from dataclasses import replace
from typing import ClassVar

import pytest

from greybox_torch.diagnosis.screen.candidates import candidates, periodic_candidates
from greybox_torch.diagnosis.screen.shortlist import identity_of
from greybox_torch.mechanisms.actuator import InputDelay
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.surroundings import Range, Surroundings
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.mechanisms.transmission import Backlash
from greybox_torch.mechanisms.transmission_error import TransmissionError
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Body, Coupling, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.systems import RobotArm


def by_port(found) -> dict[str, set[str]]:
    ports = defaultdict(set)
    for a in found:
        ports[a.port].add(a.mechanism.name)
    return dict(ports)


def library_of(kind: str) -> set[str]:
    return {name for name, mechanism in LIBRARY.items() if kind in mechanism.kinds}


def test_the_arm_is_offered_the_whole_library(arm_search) -> None:
    found = candidates(RobotArm(), arm_search.shifts, arm_search.surroundings, flexible=False)
    assert by_port(found) == {
        **{body: library_of("body") for body in ("motor", "gearbox", "arm")},
        **{spring: library_of("coupling") for spring in ("gear_spring", "arm_spring")},
        "actuator": library_of("actuator"),
        "sensor": library_of("sensor"),
    }
    assert len({identity_of(a) for a in found}) == len(found)
    positions = {a.port: a.position for a in found if a.mechanism.name in ("torque_ripple", "transmission_error")}
    assert positions == {b: b for b in ("motor", "gearbox", "arm")} | {"gear_spring": "motor", "arm_spring": "motor"}
    shifted = {a.port: a.shifted_state for a in found if a.mechanism.name == "backlash"}
    assert shifted == {"gear_spring": "+gear_twist", "arm_spring": "+arm_twist"}


def test_what_needs_a_load_is_not_offered_without_one(dead_zone_search, motor) -> None:
    found = candidates(motor, dead_zone_search.shifts, dead_zone_search.surroundings, flexible=False)
    assert by_port(found)["rotor"] == library_of("body") - {"load_dependent_friction"}


def test_curves(arm_search) -> None:
    """Of an arm that turns one way alone: none over where it is, which would be a clock."""
    found = candidates(RobotArm(), arm_search.shifts, arm_search.surroundings, flexible=True)
    assert all(isinstance(a.mechanism, Unknown) for a in found)
    signals = {(a.port, a.mechanism.signal, a.position) for a in found}
    assert signals == {
        *((b, "speed", "") for b in ("motor", "gearbox", "arm")),
        *((s, q, "") for s in ("gear_spring", "arm_spring") for q in ("deflection", "rate", "speed")),
        ("motor", "along@torque", ""),
        ("actuator", "input", ""),
        ("actuator", "time", ""),
        ("actuator", "speed", ""),
        ("sensor", "output", ""),
    }


def test_periodic_at_the_orders_found(arm_search) -> None:
    found = periodic_candidates(RobotArm(), arm_search.shifts, arm_search.surroundings, [1.0, 7.3])
    orders = defaultdict(set)
    for a in found:
        orders[a.mechanism.name].add(a.mechanism.order)
        assert a.position
    assert orders == {
        "torque_ripple": {7.3},  # once per turn is gravity
        "position_dependent_friction": {1.0, 7.3},
        "transmission_error": {1.0, 7.3},
    }


def test_play_is_a_force_where_no_state_reaches_the_spring_alone(arm_search) -> None:
    """Seen: a rack between its pinion and the tyres, whose position stretches both; play in the pinion was an unknown curve."""
    shifts = {**arm_search.shifts, "gear_spring": ""}
    found = candidates(RobotArm(), shifts, arm_search.surroundings, flexible=False)
    plays = {a.port: (a.shifted_state, a.mechanism.options()) for a in found if a.mechanism.name == "backlash"}
    assert plays == {
        "gear_spring": ("", {"as_force": True, "stiffening": False}),
        "arm_spring": ("+arm_twist", {"as_force": False, "stiffening": False}),
    }
    found += periodic_candidates(RobotArm(), shifts, arm_search.surroundings, [7.3])
    errors = {
        (a.port, a.shifted_state, a.mechanism.as_force) for a in found if isinstance(a.mechanism, TransmissionError)
    }
    assert errors == {("gear_spring", "", True), ("arm_spring", "+arm_twist", False)}
    assert "gear_spring" not in {a.port for a in found if a.mechanism.kinematic}


@pytest.mark.parametrize("held", ["motor", "arm"])
def test_a_spring_to_the_ground_is_no_gear(arm_search, monkeypatch, held) -> None:
    """Seen: the cogging of a gantry (ripple at its carriage), told as an error of its cable chain, a spring to the ground (0.85)."""
    module = sys.modules[candidates.__module__]  # the package has the function by the same name
    monkeypatch.setattr(module, "to_ground", lambda model, port, body: (port.name, body.name) == ("gear_spring", held))
    around = (arm_search.shifts, arm_search.surroundings)
    found = candidates(RobotArm(), *around, flexible=False) + periodic_candidates(RobotArm(), *around, [7.3])
    assert {a.port for a in found if a.mechanism.name == "transmission_error"} == {"arm_spring"}
    assert {a.port for a in found if a.mechanism.name == "backlash"} == {"gear_spring", "arm_spring"}


def test_attach_finds_the_body_that_a_position_belongs_to() -> None:
    arm = RobotArm()
    assert attach(arm, "gearbox", TorqueRipple()).position == "gearbox"
    assert attach(arm, "arm_spring", TransmissionError(), "+arm_twist").position == "motor"
    assert attach(arm, "motor", ConstantBias()).position == ""
    assert attach(arm, "gear_spring", Backlash(), "+gear_twist").shifted_state == "+gear_twist"
    assert attach(arm, "actuator", InputDelay()).position == ""


class Hoist(GreyBoxModel):
    """A drum that lifts a cage by a rope."""

    states: ClassVar = [State("travel", "m"), State("v", "m/s"), State("stretch", "m"), State("v_c", "m/s")]
    inputs: ClassVar = [Input("force", "N")]
    outputs: ClassVar = [Output("travel", "m")]
    parameters: ClassVar = [Parameter("k", 1e5, unit="N/m")]
    ports: ClassVar = [
        Body("drum", speed="v", position="travel"),
        Coupling("rope", deflection="stretch", rate=lambda x, u, p: x.v - x.v_c),
    ]

    def derivative(self, x, u, p, port):
        pull = p.k * x.stretch + port.rope
        return {
            "travel": x.v,
            "v": (u.force - pull + port.drum) / 100.0,
            "stretch": x.v - x.v_c,
            "v_c": pull / 100.0 - 9.81,
        }

    def output(self, x, u, p):
        return {"travel": x.travel}


def test_a_stiffness_that_changes_along_the_way_is_offered_where_the_way_is_known() -> None:
    """Seen: a hoist whose rope is the stiffer the shorter it is, told as a sensor's gain and a gap."""
    hoist = Hoist()
    signals = ("speed", "position", "deflection", "rate", "input", "time", "output")
    around = Surroundings({s: Range(0.0, 1.0, 0.5) for s in signals}, {}, "N", 1e-2)
    found = candidates(hoist, {}, dict.fromkeys([p.name for p in hoist.all_ports], around), flexible=True)
    curves = [a.mechanism for a in found if a.port == "rope"]
    assert [(c.signal, c.factor) for c in curves if isinstance(c, Unknown)] == [
        ("deflection", ""),
        ("rate", ""),
        ("speed", "rate"),
        ("position", "deflection"),
    ]
    (along,) = (a for a in found if a.port == "rope" and "position" in a.mechanism.signals())
    assert along.position == "drum"


def test_an_input_that_changes_along_the_way_is_offered_where_the_way_is_known() -> None:
    """Seen: a voice coil that leaves its gap, told as a limit of its current (0.50) with 97 % of the mismatch left."""
    hoist = Hoist()
    around = Surroundings({s: Range(0.0, 1.0, 0.5) for s in ("position", "speed", "input", "time")}, {}, "N", 1e-2)
    found = candidates(hoist, {}, dict.fromkeys([p.name for p in hoist.all_ports], around), flexible=True)
    (along,) = (a for a in found if a.port == "actuator" and "position" in a.mechanism.signals())
    assert along.mechanism.signals() == ("position", "input") and along.position == "drum"


class HoistInWind(Hoist):
    """The same with a recorded wind."""

    inputs: ClassVar = [Input("force", "N"), Input("wind", "Pa")]


@pytest.mark.parametrize(
    ("model", "products"),
    [(Hoist(), {"speed"}), (HoistInWind(), {"speed", "input@force", "input@wind"})],
    ids=["one input", "two inputs"],
)
def test_what_acts_along_a_part_of_the_way_may_grow_with_the_speed_or_with_one_of_several_inputs(
    model, products
) -> None:
    """Seen: a brake over a part of a gate's arc, told without a name; a wing that stalls, told at the input."""
    signals = ("speed", "position", "input", "input@force", "input@wind")
    around = Surroundings({s: Range(0.0, 1.0, 0.5) for s in signals}, {}, "N", 1e-2)
    found = candidates(model, {}, dict.fromkeys([p.name for p in model.all_ports], around), flexible=True)
    along = [a for a in found if a.port == "drum" and a.mechanism.signals()[0] == "position"]
    assert {a.mechanism.factor for a in along} == {"", *products}
    assert all(a.position == "drum" for a in along)
    assert len({identity_of(a) for a in along}) == len(along), "each is a hypothesis of its own"


@pytest.mark.parametrize(("low", "offered"), [(9.81, False), (9.0, True)])
def test_no_curve_is_offered_at_an_input_that_never_moves(low, offered) -> None:
    """Seen: a ball that falls, with g as its input, told as unknown at that (0.97): a gain that follows its height is a force that does."""
    hoist = Hoist()
    around = Surroundings({s: Range(0.0, 1.0, 0.5) for s in ("position", "speed", "time")}, {}, "N", 1e-2)
    ports = {p.name: replace(around, ranges={**around.ranges, "input": Range(low, 9.81, 9.5)}) for p in hoist.all_ports}
    found = candidates(hoist, {}, ports, flexible=True)
    assert ("actuator" in by_port(found)) is offered
    assert "actuator" in by_port(candidates(hoist, {}, ports, flexible=False)), "a bias of it is a law"
