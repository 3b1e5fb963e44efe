"""Curves over what a drive shows elsewhere: a belt's stiffness by where its carriage stands, what a pump delivers by its rotor's angle."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import pytest
import torch

import greybox_torch as gt
from greybox_torch.diagnosis.describe.signal_names import signal_name
from greybox_torch.diagnosis.screen.candidates import candidates
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.surroundings import surroundings_along
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.surroundings import Surroundings
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Balance, Body, Coupling, GreyBoxModel, Input, Output, Parameter, Signals, State

STATES = ("angle", "speed", "stretch", "v", "place", "pressure")


class PumpOnABelt(GreyBoxModel):
    """A motor that pulls a carriage by a belt, and turns a pump."""

    states: ClassVar = [State(n, u) for n, u in zip(STATES, ("rad", "rad/s", "m", "m/s", "m", "kPa"), strict=True)]
    inputs: ClassVar = [Input("torque", "N m")]
    outputs: ClassVar = [Output("angle", "rad"), Output("place", "m"), Output("pressure", "kPa")]
    parameters: ClassVar = [Parameter("k", 50.0, unit="N/m")]
    ports: ClassVar = [
        Body("motor", speed="speed", position="angle"),
        Body("carriage", speed="v", position="place"),
        Coupling("belt", deflection="stretch", rate=lambda x, u, p: 0.1 * x.speed - x.v),
        Balance("line", level="pressure"),
    ]

    def derivative(self, x, u, p, port):
        pull = p.k * x.stretch + port.belt
        return {
            "angle": x.speed,
            "speed": u.torque - 0.1 * pull + port.motor,
            "stretch": 0.1 * x.speed - x.v,
            "v": pull + port.carriage,
            "place": x.v,
            "pressure": 2.0 * x.speed - x.pressure + port.line,
        }

    def output(self, x, u, p):
        return {"angle": x.angle, "place": x.place, "pressure": x.pressure}


def around(turns: float) -> dict[str, Surroundings]:
    model, wave = PumpOnABelt(), np.linspace(0.0, 1.0, 40)
    columns = dict.fromkeys(("torque", "angle", "place", "pressure"), wave)
    dataset = gt.DataSet([gt.Recording.from_arrays("run", columns, sample_time=0.01)])
    problem = make_problem(dataset, model, dataset.recordings)
    reached = [2 * np.pi * turns, 8.0, 0.01, 1.0, 0.6, 30.0]
    return surroundings_along(model, problem, np.outer(np.linspace(0.0, 1.0, problem.records.u.shape[1]), reached))


def offered(turns: float, port: str) -> set[tuple[str, str]]:
    found = candidates(PumpOnABelt(), {}, around(turns), flexible=True)
    return {(a.mechanism.signal, a.mechanism.factor) for a in found if a.port == port and "@" in str(a.mechanism.reads)}


def test_the_stiffness_of_a_belt_by_where_its_carriage_stands_is_offered() -> None:
    """Seen: a gantry's belt, told as "nothing has a name" with 52 times the noise; now unknown at the belt, 99 % explained."""
    assert offered(5.0, "belt") == {("position@carriage", "deflection")}
    belt = around(5.0)["belt"]
    assert belt.ranges["position@carriage"].high == pytest.approx(0.6) and belt.units["position@carriage"] == "m"


def test_what_a_pump_delivers_by_its_angle_is_offered_where_turns_repeat() -> None:
    """Seen: the rollers of a peristaltic pump, told as a disturbance with 7 times the noise; now unknown at its line."""
    pulsation = {("turn@motor", ""), ("turn@motor", "speed@motor")}
    assert pulsation <= offered(5.0, "line")
    assert not pulsation & offered(1.2, "line")
    assert around(5.0)["line"].units["speed@motor"] == "rad/s"
    model = PumpOnABelt()
    assert signal_name(model, model.ports[3], "turn@motor") == "angle within a turn"


def rates(curve: Unknown, port: str, **state: float) -> tuple[dict[str, float], dict[str, float]]:
    """What a curve with growing heights does to the rates of the states."""
    model = PumpOnABelt()
    augmented = AugmentedModel(model, [attach(model, port, curve)], around(5.0))
    numbers = {f"{port}.unknown.w_{k}": 0.1 * (k + 1) for k in range(curve.knots)}
    p = Signals(
        "parameter", {q.name: torch.tensor(numbers.get(q.name, q.value)) for q in augmented.declared_parameters}
    )
    x = Signals("state", {n: torch.tensor(state.get(n, 0.0)) for n in STATES})
    u = Signals("input", {"torque": torch.tensor(0.0)})
    none = Signals("port", dict.fromkeys((q.name for q in model.all_ports), torch.tensor(0.0)))
    with_it, plain = augmented.derivative(x, u, p, none), model.derivative(x, u, p, none)
    return ({n: float(with_it[n] - plain[n]) for n in STATES}, {n: float(p[n]) for n in numbers})


def bumps(place: float, first: float, spacing: float, heights: dict[str, float]) -> float:
    return sum(h * np.exp(-(((place - first) / spacing - k) ** 2)) for k, h in enumerate(heights.values()))


def test_a_stiffness_by_the_place_acts_in_proportion_to_the_stretch() -> None:
    found, heights = rates(Unknown("position@carriage", 6, "deflection"), "belt", place=0.3, stretch=0.005)
    force = 0.005 * bumps(0.3, -0.2, 0.2, heights)
    assert found["v"] == pytest.approx(force, rel=1e-4) and found["speed"] == pytest.approx(-0.1 * force, rel=1e-4)
    assert found["pressure"] == 0.0


def test_pulsation_is_the_same_after_a_turn_and_in_proportion_to_the_speed() -> None:
    curve = Unknown("turn@motor", 8, "speed@motor")
    assert curve.closed
    at, heights = rates(curve, "line", angle=2.0, speed=3.0)
    later, _ = rates(curve, "line", angle=2.0 + 4 * np.pi, speed=3.0)
    wide = 2 * np.pi / 8
    whole = sum(bumps(2.0 + 2 * np.pi * k, 0.0, wide, heights) for k in (-1, 0, 1))
    assert at["pressure"] == pytest.approx(3.0 * whole, rel=1e-3) and at["speed"] == 0.0
    assert later["pressure"] == pytest.approx(at["pressure"], rel=1e-4)
