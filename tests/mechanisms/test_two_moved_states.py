"""A gear between a motor's angle and a twist: the link's angle follows from both, and its weight depends on it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.mechanisms.transmission import Backlash
from greybox_torch.mechanisms.transmission_error import TransmissionError
from greybox_torch.model import Body, Coupling, GreyBoxModel, Input, Output, Parameter, Signals, State
from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.windows import whole_records
from tests.mechanisms.attaching import attached, coupling_along_a_free_run, records_of, starts


class Elbow(GreyBoxModel):
    """A motor, a gear's spring and a link with its weight, all angles on the link's side."""

    states = [State("motor", "rad"), State("twist", "rad"), State("w_m", "rad/s"), State("w_l", "rad/s")]
    inputs = [Input("torque", "N m")]
    outputs = [Output("motor", "rad"), Output("link", "rad")]
    parameters = [
        Parameter("J_m", 0.05, "kg m^2"),
        Parameter("J_l", 0.1, "kg m^2"),
        Parameter("k", 300.0, "N m/rad"),
        Parameter("m", 3.0, "N m"),
    ]
    ports = [
        Body("motor_shaft", speed="w_m", position="motor"),
        Body("link", speed="w_l", position=lambda x, u, p: x.motor - x.twist),
        Coupling("gear", deflection="twist", rate=lambda x, u, p: x.w_m - x.w_l),
    ]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        spring = p.k * x.twist + port.gear
        weight = p.m * torch.sin(x.motor - x.twist)
        return {
            "motor": x.w_m,
            "twist": x.w_m - x.w_l,
            "w_m": (u.torque - spring + port.motor_shaft) / p.J_m,
            "w_l": (spring - weight + port.link) / p.J_l,
        }

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"motor": x.motor, "link": x.motor - x.twist}


ELBOW = Elbow()


@pytest.fixture(scope="module")
def gear() -> tuple[Surroundings, str]:
    """The gear's surroundings and the states by which its deflection can be changed, along a free run."""
    return coupling_along_a_free_run(ELBOW, "gear")


def test_the_motor_and_the_twist_move_together(gear) -> None:
    around, shifted = gear
    assert shifted == "+twist+motor"
    assert around.ranges["load"].reach == pytest.approx(300.0 * around.ranges["deflection"].reach, rel=1e-6)


def rates_at(model: GreyBoxModel, values: dict[str, float]) -> dict[str, float]:
    """The rates of a model where its motor is at 0.7 rad, the gear twisted by 0.03, with 0.5 N m."""
    x = {"motor": 0.7, "twist": 0.03, "w_m": 2.0, "w_l": 1.0}
    p = {**model.values(), **values}
    ports = dict.fromkeys((q.name for q in model.all_ports), 0.0)
    named = (("state", x), ("input", {"torque": 0.5}), ("parameter", p), ("port", ports))
    signals = [Signals(k, {n: torch.tensor(float(v), dtype=torch.float64) for n, v in one.items()}) for k, one in named]
    return {n: float(rate) for n, rate in model.derivative(*signals).items()}


def test_play_leaves_the_weight_as_it_is(gear) -> None:
    """The spring sees the twist less its dead zone, and the weight the link's own angle."""
    around, shifted = gear
    play = Attachment("gear", Backlash(), shifted_state=shifted)
    rates = rates_at(attached(ELBOW, around, play), {f"{play.prefix}.half_gap": 0.01})
    weight = 3.0 * np.sin(0.7 - 0.03)
    assert rates["w_l"] == pytest.approx((300.0 * 0.02 - weight) / 0.1)
    assert rates["w_m"] == pytest.approx((0.5 - 300.0 * 0.02) / 0.05)
    assert rates["twist"] == pytest.approx(2.0 - 1.0) and rates["motor"] == pytest.approx(2.0)


@pytest.mark.parametrize(("body", "angle", "rate"), [("motor_shaft", 0.7, "w_m"), ("link", 0.67, "w_l")])
def test_bodies_are_where_they_are_whatever_the_spring_sees(gear, body, angle, rate) -> None:
    """Cogging beside play follows the body's own angle, not what is moved to change the deflection."""
    around, shifted = gear
    place = replace(around, ranges={**around.ranges, "position": around.ranges["deflection"]})
    play = Attachment("gear", Backlash(), shifted_state=shifted)
    ripple = Attachment(body, TorqueRipple(8.0), position=body)
    values = {f"{play.prefix}.half_gap": 0.01, f"{ripple.prefix}.a": 0.2}
    inertia = {"w_m": 0.05, "w_l": 0.1}[rate]
    model = attached(ELBOW, place, play, ripple)
    cogging = inertia * (rates_at(model, values)[rate] - rates_at(model, {**values, f"{ripple.prefix}.a": 0.0})[rate])
    assert cogging == pytest.approx(0.2 * np.cos(8.0 * angle))


@pytest.mark.parametrize(("share", "conserved"), [(1.0, True), (0.0, False)])
def test_an_error_of_the_gear_conserves_energy_with_the_weight(gear, share, conserved) -> None:
    """Virtual work, without damper and input: the weight's energy is that of the link's own angle."""
    around, shifted = gear
    error = Attachment("gear", TransmissionError(3.0), position="motor_shaft", shifted_state=shifted)
    model = attached(ELBOW, around, error)
    value = {
        **model.values(),
        **{f"{error.prefix}.{n}": v for n, v in {"a": 0.02, "b": 0.015, "reaction": share}.items()},
    }
    records = replace(records_of(300, step=1e-3), u=np.zeros((1, 300)))
    begun = starts(model, np.array([[0.7, 0.02, 4.0, 3.0]]))
    p = np.array([value[q.name] for q in model.declared_parameters])
    run = EagerStepper.of(model, (), "cpu", "double").run(
        records, Pass(whole_records(records), p, begun, keep_states=True)
    )
    assert run.states is not None
    motor, twist, w_m, w_l = run.states[0].T
    stretched = twist + 0.02 * np.cos(3.0 * motor) + 0.015 * np.sin(3.0 * motor)
    energy = 0.5 * 300.0 * stretched**2 + 0.5 * 0.05 * w_m**2 + 0.5 * 0.1 * w_l**2 + 3.0 * (1.0 - np.cos(motor - twist))
    assert (np.ptp(energy) < 1e-5 * energy[0]) == conserved
