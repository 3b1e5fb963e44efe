"""Curves over signals of other parts of a machine: which are offered, and what they do."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import pytest
import torch

import greybox_torch as gt
from greybox_torch.diagnosis.describe.signal_names import signal_name
from greybox_torch.diagnosis.screen import further_curves
from greybox_torch.diagnosis.screen.candidates import candidates
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.surroundings import surroundings_along
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.surroundings import Surroundings
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Balance, Body, GreyBoxModel, Input, Output, Parameter, Signals, State


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
    states = np.linspace((0.0, 0.0, -1.0, -1.0, 0.0), (0.5, 2.0, 1.0, 1.0, 20.0), problem.records.u.shape[1])
    return surroundings_along(helicopter, problem, states)


def test_what_one_axis_does_to_the_other_is_offered(surroundings) -> None:
    """Seen: the main rotor of a laboratory helicopter turned its yaw axis, by what its pitch let it: "without a name", after 119 s."""
    found = candidates(Helicopter(), {}, surroundings, flexible=True)
    curves = {(a.port, a.mechanism.signal, a.mechanism.factor) for a in found if isinstance(a.mechanism, Unknown)}
    for body, other in (("pitch_axis", "yaw_axis"), ("yaw_axis", "pitch_axis")):
        any_factor = ("", "input@main", "input@tail", "position", f"rate@{body}")
        own = {(body, f"position@{other}", factor) for factor in any_factor}
        warm = {(body, "level@motor_heat", factor) for factor in (*any_factor, "speed", f"direction@{body}")}
        there = {c for c in curves if c[0] == body and "@" in c[1] and not c[1].startswith("along@")}
        fast = {(body, f"speed@{other}", factor) for factor in ("", "position", "speed")}
        assert there == own | warm | fast | {(body, "input@tail" if body == "pitch_axis" else "input@main", "")}
        assert {(body, "position", f"rate@{body}"), (body, "position", f"direction@{body}")} <= curves
    assert surroundings["yaw_axis"].ranges["position@pitch_axis"].high == pytest.approx(0.5)
    assert surroundings["yaw_axis"].units["position@pitch_axis"] == "rad"


def test_an_input_that_changes_a_loss_is_offered_at_a_balance(surroundings) -> None:
    """Seen: a fan that cooled a wall, and that the model did not use: "something, without a name", after 91 s."""
    found = candidates(Helicopter(), {}, surroundings, flexible=True)
    curves = (a for a in found if a.port == "motor_heat" and isinstance(a.mechanism, Unknown))
    at_heat = {(a.mechanism.signal, a.mechanism.factor) for a in curves}
    changed = {("level", factor) for factor in ("", "input@main", "input@tail", "rate@motor_heat")}
    assert at_heat == {*changed, *((f"input@{name}", factor) for name in ("main", "tail") for factor in ("", "level"))}


class Cell(GreyBoxModel):
    """A battery's charge, its surface and its core, with one input."""

    states: ClassVar = [State("soc", ""), State("surface", "K"), State("core", "K")]
    inputs: ClassVar = [Input("current", "A")]
    outputs: ClassVar = [Output("surface", "K")]
    parameters: ClassVar = [Parameter("C", 50.0, unit="J/K")]
    ports: ClassVar = [
        Balance("charge", level="soc"),
        Balance("skin", level="surface"),
        Balance("heat", level=lambda x, u, p: 0.5 * (x.surface + x.core)),
    ]

    def derivative(self, x, u, p, port):
        return {
            "soc": -u.current + port.charge,
            "surface": (x.core - x.surface + port.skin) / p.C,
            "core": (x.surface - x.core + port.heat) / p.C,
        }

    def output(self, x, u, p):
        return {"surface": x.surface}


def test_a_balance_is_offered_the_levels_of_others_and_its_only_input() -> None:
    """Seen: the heat of a battery's reaction, the current times a curve of the charge: "without a name", after 142 s.

    And a battery whose polarisation fades by a curve of the charge: "without a name", after 53 s.
    """
    cell, wave = Cell(), np.sin(np.arange(40.0) / 5)
    dataset = gt.DataSet([gt.Recording.from_arrays("run", {"current": wave, "surface": wave}, sample_time=1.0)])
    problem = make_problem(dataset, cell, dataset.recordings)
    around = surroundings_along(
        cell, problem, np.outer(np.linspace(0.0, 1.0, problem.records.u.shape[1]), [0.8, 5.0, 9.0])
    )
    curves = [a for a in candidates(cell, {}, around, flexible=True) if isinstance(a.mechanism, Unknown)]
    at_heat = {(a.mechanism.signal, a.mechanism.factor) for a in curves if a.port == "heat"}
    others = {(f"level@{name}", factor) for name in ("charge", "skin") for factor in ("", "input@current", "level")}
    assert at_heat == {("level", ""), *others}, "the mean of two states is a level of no unit of its own"
    assert around["charge"].ranges["level@heat"].high == pytest.approx(7.0)
    assert around["heat"].ranges["input@current"].low < 0.0
    assert not [a for a in candidates(cell, {}, around, flexible=True, knots=40) if "@" in str(a.mechanism.signals())]


class Exchanger(GreyBoxModel):
    """A heater, the water that flows through it, and what dirt there is in it."""

    states: ClassVar = [State("hot", "K"), State("cold", "K"), State("dirt", "kg")]
    inputs: ClassVar = [Input("power", "kW"), Input("flow", "kg/s")]
    outputs: ClassVar = [Output("cold", "K")]
    parameters: ClassVar = [Parameter("U", 2.0, unit="kW/K")]
    ports: ClassVar = [
        Balance("heater", level="hot"),
        Balance("water", level="cold"),
        Balance("filter", level="dirt"),
    ]

    def derivative(self, x, u, p, port):
        heat = p.U * (x.hot - x.cold)
        return {
            "hot": (u.power - heat + port.heater) / 10.0,
            "cold": (heat - 4.0 * u.flow * x.cold + port.water) / 30.0,
            "dirt": port.filter + 0.0 * x.dirt,
        }

    def output(self, x, u, p):
        return {"cold": x.cold}


@pytest.fixture(scope="module")
def exchanger() -> tuple[Exchanger, dict[str, Surroundings]]:
    model, wave = Exchanger(), 1.0 + 0.5 * np.sin(np.arange(40.0) / 5)
    recording = gt.Recording.from_arrays("run", {"power": wave, "flow": wave, "cold": wave}, sample_time=1.0)
    problem = make_problem(gt.DataSet([recording]), model, (recording,))
    states = np.outer(np.linspace(0.0, 1.0, problem.records.u.shape[1]), [30.0, 10.0, 1.0])
    return model, surroundings_along(model, problem, states)


def test_what_two_balances_exchange_is_offered_once_where_their_levels_have_one_unit(exchanger) -> None:
    """Seen: heat from a heater to water, more of it the faster that flows: told as a sensor's lag (0.50), 95 % left; now 0.4 %."""
    model, around = exchanger
    curves = [a for a in candidates(model, {}, around, flexible=True) if isinstance(a.mechanism, Unknown)]
    found = {(a.port, a.mechanism.signal, a.mechanism.factor) for a in curves if "difference" in str(a.mechanism.reads)}
    by = ("input@power", "input@flow", "level", "level@water")
    apart = "difference@water"
    assert found == {("heater", apart, ""), *(("heater", signal, apart) for signal in by)}
    assert around["heater"].ranges[apart].high == pytest.approx(20.0)
    assert around["heater"].units[apart] == "K"
    assert signal_name(model, model.ports[0], apart) == "hot - cold"


def test_what_one_balance_loses_the_other_has(exchanger) -> None:
    model, around = exchanger
    curve = attach(model, "heater", Unknown("input@flow", 6, "difference@water"))
    augmented = AugmentedModel(model, [curve], around)
    p = Signals("parameter", {q.name: torch.tensor(q.value) for q in augmented.declared_parameters})
    p = p.replaced(**{n: torch.tensor(0.5) for n in p if ".w_" in n})
    x = Signals("state", {"hot": torch.tensor(25.0), "cold": torch.tensor(5.0), "dirt": torch.tensor(0.0)})
    u = Signals("input", {"power": torch.tensor(0.0), "flow": torch.tensor(1.0)})
    none = Signals("port", dict.fromkeys((q.name for q in model.all_ports), torch.tensor(0.0)))
    plain, now = model.derivative(x, u, p, none), augmented.derivative(x, u, p, none)
    heat = 10.0 * float(now["hot"] - plain["hot"])
    assert abs(heat) > 1.0 and 30.0 * float(now["cold"] - plain["cold"]) == pytest.approx(-heat, rel=1e-5)
    assert float(now["dirt"]) == 0.0


def test_ports_take_the_few_curves_of_signals_elsewhere_in_turn(monkeypatch) -> None:
    monkeypatch.setattr(further_curves, "MOST_FROM_ELSEWHERE", 4)
    ways = [(port.name, curve.signal, curve.factor) for port, curve in further_curves._from_elsewhere(Cell(), 6)]
    assert ways == [
        ("charge", "level@skin", ""),
        ("skin", "level@charge", ""),
        ("heat", "level@charge", ""),
        ("actuator", "level@charge", "input"),
    ]


def test_what_a_level_does_to_the_gain_of_an_actuator_is_offered(surroundings) -> None:
    """Seen: a membrane that lets less through the thicker what is behind it: without a name after 147 s; now unknown at its pressure."""
    found = candidates(Helicopter(), {}, surroundings, flexible=True)
    curves = [a for a in found if isinstance(a.mechanism, Unknown) and a.port.startswith("actuator")]
    over_heat = {(a.port, a.mechanism.factor) for a in curves if a.mechanism.signal == "level@motor_heat"}
    assert over_heat == {("actuator.main", "input"), ("actuator.tail", "input")}


def test_a_saved_effect_that_reads_what_a_model_lacks_is_refused(surroundings) -> None:
    curve = attach(Helicopter(), "yaw_axis", Unknown("position@roll_axis", 6))
    with pytest.raises(gt.UserError, match=r"has no port 'roll_axis', which the effect at 'yaw_axis' depends on"):
        AugmentedModel(Helicopter(), [curve], surroundings)
    curve = attach(Helicopter(), "yaw_axis", Unknown("position@pitch_axis", 6, "input@rotor"))
    with pytest.raises(gt.UserError, match=r"has no input 'rotor', which .* \(it has: main, tail\)"):
        AugmentedModel(Helicopter(), [curve], surroundings)


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
