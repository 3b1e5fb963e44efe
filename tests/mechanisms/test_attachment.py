"""The model that results from attaching mechanisms to ports: labels, start values, where a memory begins."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greybox_torch.errors import UserError
from greybox_torch.estimate.problem import make_problem, problem_for
from greybox_torch.mechanisms.actuator import InputLag
from greybox_torch.mechanisms.forces import AdditionalMode
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.sensor import SensorLag
from greybox_torch.model import Body, GreyBoxModel, Input, Output, Parameter, State
from tests.mechanisms.attaching import ARM, at, attached


class Cart(GreyBoxModel):
    """Two inputs in one unit, outputs as given."""

    states = [State("place", "m"), State("speed", "m/s")]
    inputs = [Input("push", "N"), Input("pull", "N")]
    parameters = [Parameter("m", 2.0, "kg")]
    ports = [Body("cart", speed="speed", position="place")]

    def __init__(self, *outputs: Output) -> None:
        self.outputs = list(outputs)
        super().__init__()

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"place": x.speed, "speed": (u.push - u.pull + port.cart) / p.m}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {o.name: x.place if o.unit == "m" else x.speed for o in self.outputs}


@pytest.mark.parametrize(
    ("outputs", "port", "mechanism", "expected"),
    [
        ([Output("place", "m")], "actuator.pull", InputLag(), 30.0),
        ([Output("place", "m"), Output("again", "m")], "sensor.again", SensorLag(), 7.0),
        ([Output("place", "m"), Output("tacho", "m/s")], "cart", AdditionalMode(), 20.0),
        ([Output("place", "m")], "cart", AdditionalMode(), 20.0),  # nothing measures the speed
    ],
)
def test_memory_begins_settled(around, data_set, outputs, port, mechanism, expected) -> None:
    cart = Cart(*outputs)
    signals = {"push": 40.0, "pull": 30.0, **{o.name: 10.0 for o in outputs}}
    units = {i.name: i.unit for i in (*cart.inputs, *outputs)}
    dataset = data_set(
        units,
        [{name: np.full(20, value) for name, value in signals.items()}],
        initial={"place": {"value": 7.0}, "speed": {"value": 20.0}},
    )
    problem = make_problem(dataset, cart, dataset.recordings)
    assert problem_for(problem, attached(cart, around, at(port, mechanism)), {}).initial[0, -1] == expected


def test_several_of_a_kind_are_told_apart_by_label(around) -> None:
    model = attached(ARM, around, *(at("motor", CoulombFriction(), label=f"#{k}") for k in (1, 2)))
    assert [p.name for p in model.declared_parameters[13:]] == [
        f"motor.coulomb_friction#{k}.{n}" for k in (1, 2) for n in ("F_c", "v_0")
    ]


def test_port_that_is_not_there(around) -> None:
    with pytest.raises(UserError, match=r"model robot_arm has no port 'wheel' \(it has: motor, gearbox, arm, gear_s"):
        attached(ARM, around, at("wheel", CoulombFriction()))


def test_start_values_replace_the_declared_within_bounds(around) -> None:
    friction = at("motor", CoulombFriction())
    model = attached(ARM, around, friction, start={"motor.coulomb_friction.F_c": -3.0, "F_v": 0.5})
    assert (model.values()["motor.coulomb_friction.F_c"], model.values()["F_v"]) == (0.0, 0.5)
