"""Forms with more parameters are asked where their port has what they need."""

from __future__ import annotations

from typing import Any, ClassVar

import pytest

from greybox_torch.diagnosis.refit.possible_form import possible_form
from greybox_torch.mechanisms.actuator import TorqueSaturation
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.surroundings import Range, Surroundings
from greybox_torch.model import Balance, Body, GreyBoxModel, Input, Output, Parameter, State


class TwoAxes(GreyBoxModel):
    """Two bodies with an input each, and a tank."""

    states: ClassVar = [State("first", "rad/s"), State("second", "rad/s"), State("level", "m")]
    inputs: ClassVar = [Input("one", "N m"), Input("other", "N m"), Input("flow", "m/s")]
    outputs: ClassVar = [Output("first", "rad/s")]
    parameters: ClassVar = [Parameter("J", 0.1, "kg m^2")]
    ports: ClassVar = [Body("a", speed="first"), Body("b", speed="second"), Balance("tank", level="level")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"first": (u.one + port.a) / p.J, "second": (u.other + port.b) / p.J, "level": u.flow + port.tank}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"first": x.first}


@pytest.mark.parametrize(("name", "with_power"), [("one", True), ("other", False), ("flow", False)])
def test_a_limit_falls_with_the_speed_of_the_body_that_its_input_drives(stub, name: str, with_power: bool) -> None:
    """The speed at an actuator is that of the first body."""
    model, port = TwoAxes(), f"actuator.{name}"
    around = Surroundings({n: Range(-1.0, 1.0, 0.5) for n in ("input", "speed")}, {}, "N m", 1e-3)
    study = stub(surroundings={port: around}, problem=stub(model=model))
    assert possible_form(study, attach(model, port, TorqueSaturation(limited_power=True))) is with_power
    assert possible_form(study, attach(model, port, TorqueSaturation(by_direction=True)))


def test_where_nothing_moves_no_limit_falls_with_speed(stub) -> None:
    """Seen by reading: of a model of balances alone the speed would have been asked all the same."""
    model = TwoAxes()
    around = Surroundings({"input": Range(-1.0, 1.0, 0.5)}, {}, "N m", 1e-3)
    study = stub(surroundings={"actuator.flow": around}, problem=stub(model=model))
    assert not possible_form(study, attach(model, "actuator.flow", TorqueSaturation(limited_power=True)))
