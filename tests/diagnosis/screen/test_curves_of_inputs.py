"""Curves of what an input does where a model does not have it, and of what acts by where a body is: which are offered, and what they do."""

from __future__ import annotations

from typing import ClassVar

import pytest
import torch

from greybox_torch.diagnosis.screen.further_curves import further_curves
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.surroundings import Range, Surroundings
from greybox_torch.model import Balance, Body, Coupling, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.model.random_points import random_points


class Stage(GreyBoxModel):
    """A Peltier element pumps heat out of a plate, by its current and the plate's temperature; a sample stands on the plate."""

    states: ClassVar = [State("plate", "K"), State("sample", "K")]
    inputs: ClassVar = [Input("current", "A"), Input("base", "K")]
    outputs: ClassVar = [Output("sample", "K")]
    parameters: ClassVar = [Parameter("alpha", 0.05, unit="W/(A K)")]
    ports: ClassVar = [Balance("plate_heat", level="plate"), Balance("sample_heat", level="sample")]

    def derivative(self, x, u, p, port):
        pumped = p.alpha * x.plate * u.current
        return {
            "plate": u.base - x.plate - pumped + port.plate_heat,
            "sample": x.plate - x.sample + port.sample_heat,
        }

    def output(self, x, u, p):
        return {"sample": x.sample}


class Ship(GreyBoxModel):
    """A rudder turns a ship; its roll, and a mast on a spring, are pushed by nothing; a pump fills a tank."""

    states: ClassVar = [
        State(n, unit)
        for n, unit in (
            ("heading", "rad"),
            ("turning", "rad/s"),
            ("heel", "rad"),
            ("rolling", "rad/s"),
            ("bend", "rad"),
            ("swaying", "rad/s"),
            ("ballast", "m"),
        )
    ]
    inputs: ClassVar = [Input("rudder", "rad"), Input("pump", "V")]
    outputs: ClassVar = [Output("heel", "rad")]
    parameters: ClassVar = [Parameter("k", 5.0, unit="N m/rad")]
    ports: ClassVar = [
        Body("yaw", speed="turning", position="heading"),
        Body("roll", speed="rolling", position="heel"),
        Body("mast", speed="swaying", position="bend"),
        Coupling("stay", deflection=lambda x, u, p: x.heel - x.bend, rate=lambda x, u, p: x.rolling - x.swaying),
        Balance("tank", level="ballast"),
    ]

    def derivative(self, x, u, p, port):
        stay = p.k * (x.heel - x.bend) + port.stay
        return {
            "heading": x.turning,
            "turning": u.rudder + port.yaw,
            "heel": x.rolling,
            "rolling": -x.heel - stay + port.roll,
            "bend": x.swaying,
            "swaying": stay + port.mast,
            "ballast": u.pump + port.tank,
        }

    def output(self, x, u, p):
        return {"heel": x.heel}


def ways(model: GreyBoxModel) -> set[tuple[str, str, str]]:
    return {(port.name, curve.signal, curve.factor) for port, curve in further_curves(model, 6)}


def test_an_input_is_offered_where_it_does_not_act_or_acts_by_a_state_alone() -> None:
    """Seen: the heat that a current makes in a Peltier element, told at the actuator of that current."""
    alone = {(port, signal) for port, signal, factor in ways(Stage()) if signal.startswith("input@") and not factor}
    assert alone == {("plate_heat", "input@current"), ("sample_heat", "input@current"), ("sample_heat", "input@base")}


def test_an_input_is_offered_at_a_body_that_it_does_not_push_nor_what_a_spring_joins_with_it() -> None:
    offered = {w for w in ways(Ship()) if w[1].startswith("input@")}
    assert {p for p, signal, _ in offered if signal == "input@rudder"} == {"roll", "mast", "tank"}
    assert {p for p, signal, _ in offered if signal == "input@pump"} == {"yaw", "roll", "mast"}


class Pushed(Ship):
    """The same, where the rudder heels the ship as well."""

    def derivative(self, x, u, p, port):
        rates = super().derivative(x, u, p, port)
        return {**rates, "rolling": rates["rolling"] + 0.1 * u.rudder}


def test_what_is_joined_with_a_body_that_an_input_pushes_is_not_offered_that_input() -> None:
    assert {p for p, signal, _ in ways(Pushed()) if signal == "input@rudder"} == {"tank"}


def test_what_a_level_or_another_axis_does_by_where_a_body_is_is_offered() -> None:
    """Seen: a fan near the ground, told as a gain and a stop; a slider that a turntable throws outwards, told without its radius."""
    offered = ways(Ship())
    assert {
        ("roll", "position", "level@tank"),
        ("roll", "level@tank", "position"),
        ("roll", "speed@yaw", "position"),
    } <= offered


@pytest.mark.parametrize("model", [Stage(), Ship()], ids=["stage", "ship"])
def test_every_curve_that_is_offered_acts_in_proportion_to_its_factor(model: GreyBoxModel) -> None:
    *points, p = random_points(model)
    x, u = model.named_signals(*points)
    for port, curve in further_curves(model, 6):
        ranges = dict.fromkeys({"speed", "position", "level", *curve.signals()}, Range(-2.0, 2.0, 1.0))
        around = {q.name: Surroundings(ranges, {}, "N", 1e-2) for q in model.all_ports}
        attached = attach(model, port.name, curve)
        augmented = AugmentedModel(model, [attached], around)
        values = {q.name: torch.tensor(q.value) for q in augmented.declared_parameters}
        known = type(p)("parameter", {**values, **{n: p[n] for n in p}})
        local = augmented.local.at(attached, x, u, known)
        assert {n for n in curve.signals() if not n.startswith("rate@")} <= set(local), curve.signals()
        if curve.factor and not curve.by_rate:
            declared = curve.parameters(around[port.name])
            own = type(p)("parameter", {q.name: torch.tensor(0.3 if q.shrunk else q.value) for q in declared})
            force, height = curve.force(local, own, type(p)("memory", {})), curve.curve(local, own)
            torch.testing.assert_close(force, height * local[curve.factor])
