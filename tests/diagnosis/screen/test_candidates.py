"""Which mechanism is offered at which port."""

from __future__ import annotations

from collections import defaultdict
from typing import ClassVar

import numpy as np
import pytest
import torch

import greybox_torch as gt
from greybox_torch.diagnosis.screen.candidates import candidates, periodic_candidates
from greybox_torch.diagnosis.screen.shortlist import identity_of
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.surroundings import surroundings_along
from greybox_torch.mechanisms.actuator import InputDelay
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.forces import ConstantBias, TorqueRipple
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.surroundings import Range, Surroundings
from greybox_torch.mechanisms.transmission import Backlash
from greybox_torch.mechanisms.transmission_error import TransmissionError
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Balance, Body, Coupling, GreyBoxModel, Input, Output, Parameter, Signals, State
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
    assert len({(a.port, a.mechanism.name) for a in found}) == len(found)
    positions = {a.port: a.position for a in found if a.mechanism.name in ("torque_ripple", "transmission_error")}
    assert positions == {b: b for b in ("motor", "gearbox", "arm")} | {"gear_spring": "motor", "arm_spring": "motor"}
    shifted = {a.port: a.shifted_state for a in found if a.mechanism.name == "backlash"}
    assert shifted == {"gear_spring": "+gear_twist", "arm_spring": "+arm_twist"}


def test_what_needs_a_load_is_not_offered_without_one(dead_zone_search, motor) -> None:
    found = candidates(motor, dead_zone_search.shifts, dead_zone_search.surroundings, flexible=False)
    assert by_port(found)["rotor"] == library_of("body") - {"load_dependent_friction"}


def test_curves(arm_search) -> None:
    found = candidates(RobotArm(), arm_search.shifts, arm_search.surroundings, flexible=True)
    assert all(isinstance(a.mechanism, Unknown) for a in found)
    signals = {(a.port, a.mechanism.signal, a.position) for a in found}
    assert signals == {
        *((b, "speed", "") for b in ("motor", "gearbox", "arm")),
        *((b, "position", b) for b in ("motor", "gearbox", "arm")),
        *((s, q, "") for s in ("gear_spring", "arm_spring") for q in ("deflection", "rate", "speed")),
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
    assert plays == {"gear_spring": ("", {"as_force": True}), "arm_spring": ("+arm_twist", {"as_force": False})}
    assert "gear_spring" not in {a.port for a in found if a.mechanism.kinematic}


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


class Helicopter(GreyBoxModel):
    """Two axes, each with a rotor of its own, and how warm a motor gets."""

    states: ClassVar = [
        State(n, unit)
        for n, unit in (("pitch", "rad"), ("yaw", "rad"), ("w_p", "rad/s"), ("w_y", "rad/s"), ("warm", "K"))
    ]
    inputs: ClassVar = [Input("main", "V"), Input("tail", "V")]
    outputs: ClassVar = [Output("pitch", "rad"), Output("yaw", "rad"), Output("warm", "K")]
    parameters: ClassVar = [Parameter("J", 0.03, unit="kg m^2")]
    ports: ClassVar = [
        Body("pitch_axis", speed="w_p", position="pitch"),
        Body("yaw_axis", speed="w_y", position="yaw"),
        Balance("motor_heat", level="warm"),
    ]

    def derivative(self, x, u, p, port):
        rates = {"w_p": (u.main + port.pitch_axis) / p.J, "w_y": (u.tail + port.yaw_axis) / p.J}
        return {"pitch": x.w_p, "yaw": x.w_y, "warm": port.motor_heat - x.warm, **rates}

    def output(self, x, u, p):
        return {"pitch": x.pitch, "yaw": x.yaw, "warm": x.warm}


@pytest.fixture(scope="module")
def surroundings() -> dict[str, Surroundings]:
    helicopter = Helicopter()
    dataset = gt.DataSet(
        [
            gt.Recording.from_arrays(
                "turns",
                {
                    n: np.sin(np.arange(50.0) * (k + 1) / 9)
                    for k, n in enumerate(("main", "tail", "pitch", "yaw", "warm"))
                },
                sample_time=0.01,
            )
        ]
    )
    problem = make_problem(dataset, helicopter, dataset.recordings)
    states = np.stack([np.linspace(0.0, top, problem.records.u.shape[1]) for top in (0.5, 2.0, 1.0, 1.0, 20.0)], axis=1)
    return surroundings_along(helicopter, problem, states)


def test_what_one_axis_does_to_the_other_is_offered(surroundings) -> None:
    """Seen: the main rotor of a laboratory helicopter turned its yaw axis, by what its pitch let it: "without a name", after 119 s."""
    found = candidates(Helicopter(), {}, surroundings, flexible=True)
    curves = {(a.port, a.mechanism.signal, a.mechanism.factor) for a in found if isinstance(a.mechanism, Unknown)}
    for body, other in (("pitch_axis", "yaw_axis"), ("yaw_axis", "pitch_axis")):
        own = {(body, f"position@{other}", factor) for factor in ("", "input@main", "input@tail")}
        warm = {(body, "level@motor_heat", factor) for factor in ("", "speed", "input@main", "input@tail")}
        assert {c for c in curves if c[0] == body and "@" in c[1]} == own | warm
    assert surroundings["yaw_axis"].ranges["position@pitch_axis"].high == pytest.approx(0.5)
    assert surroundings["yaw_axis"].units["position@pitch_axis"] == "rad"


def test_an_input_that_changes_a_loss_is_offered_at_a_balance(surroundings) -> None:
    """Seen: a fan that cooled a wall, and that the model did not use: "something, without a name", after 91 s."""
    found = candidates(Helicopter(), {}, surroundings, flexible=True)
    at_heat = {
        (a.mechanism.signal, a.mechanism.factor)
        for a in found
        if a.port == "motor_heat" and isinstance(a.mechanism, Unknown)
    }
    assert at_heat == {("level", ""), ("level", "input@main"), ("level", "input@tail")}


def test_a_curve_of_another_axis_pushes_by_where_that_stands(surroundings) -> None:
    model = Helicopter()
    curve = attach(model, "yaw_axis", Unknown("position@pitch_axis", 6, "input@main"))
    augmented = AugmentedModel(model, [curve], surroundings)
    heights = {f"w_{k}": 0.1 * (k + 1) for k in range(6)}
    p = Signals(
        "parameter",
        {q.name: torch.tensor(heights.get(q.name.rpartition(".")[2], q.value)) for q in augmented.declared_parameters},
    )
    x = Signals(
        "state",
        {
            "pitch": torch.tensor(0.3),
            "yaw": torch.tensor(1.7),
            **dict.fromkeys(("w_p", "w_y", "warm"), torch.tensor(0.0)),
        },
    )
    u = Signals("input", {"main": torch.tensor(2.0), "tail": torch.tensor(0.0)})
    none = Signals("port", dict.fromkeys((q.name for q in model.all_ports), torch.tensor(0.0)))
    rates = augmented.derivative(x, u, p, none)
    spacing = 0.5 / 3
    bumps = sum(0.1 * (k + 1) * np.exp(-(((0.3 + spacing) / spacing - k) ** 2)) for k in range(6))
    assert float(rates["w_y"]) == pytest.approx(2.0 * bumps / 0.03, rel=1e-5)
    assert float(rates["w_p"]) == pytest.approx(2.0 / 0.03)
