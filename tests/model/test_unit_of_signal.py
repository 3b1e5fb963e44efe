"""Units of signals that a model gives as functions of its states."""

from __future__ import annotations

import pytest
import torch

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.mechanisms.added_declarations import position_unit
from greybox_torch.model.unit_of_signal import unit_of_signal


class Leg(GreyBoxModel):
    """Two links on a carriage; none of its bodies' signals matters here."""

    states = [State(name, "rad") for name in ("hip", "knee")] + [State("carriage", "m"), State("rate", "rad/s")]
    inputs = [Input("ground", "m")]
    outputs = [Output("hip", "rad")]
    parameters = [Parameter("radius", 0.3, unit="m")]
    ports = [Body("thigh", speed="rate", position="hip")]

    def derivative(self, x, u, p, port):
        return {"hip": x.rate, "knee": x.rate, "carriage": p.radius * x.rate, "rate": port.thigh}


@pytest.mark.parametrize(
    ("signal", "unit"),
    [
        ("knee", "rad"),
        (lambda x, u, p: x.hip + x.knee, "rad"),
        (lambda x, u, p: x.hip - x.knee + torch.pi / 2, "rad"),
        (lambda x, u, p: u.ground - x.carriage, "m"),
        (lambda x, u, p: p.radius * x.hip, ""),
        (lambda x, u, p: x.hip / 2, ""),
        (lambda x, u, p: torch.sin(x.hip), ""),
        (lambda x, u, p: x.hip + x.carriage, ""),
        (lambda x, u, p: u.ground, ""),
        (lambda x, u, p: 0.0, ""),
    ],
)
def test_sums_of_states_of_one_unit_have_that_unit(signal, unit: str) -> None:
    assert unit_of_signal(Leg(), signal) == unit


@pytest.mark.parametrize(
    ("body", "unit"),
    [
        (Body("shank", speed="rate", position=lambda x, u, p: x.hip + x.knee), "rad"),
        (Body("shank", speed="rate", position=lambda x, u, p: 2.0 * x.hip), "rad"),
        (Body("shank", speed=lambda x, u, p: 2.0 * x.rate, position=lambda x, u, p: 2.0 * x.hip), ""),
        (Body("shank", speed=lambda x, u, p: x.rate - x.rate / 1.0, position="carriage"), "m"),
        (Body("shank", speed=lambda x, u, p: x.rate), "rad"),
    ],
)
def test_a_position_of_no_known_unit_has_that_of_its_speeds_integral(body: Body, unit: str) -> None:
    assert position_unit(Leg(), body) == unit
