"""One joint of a seven-axis arm, motor side: the motion is given, the motor's torque is measured."""

from __future__ import annotations

from typing import Any

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State


class ArmJointTorque(GreyBoxModel):
    """motor = joint + J dv/dt + b v, without dry friction: the torque of the motor's current against that of the joint's sensor."""

    states = [State("lagging", "rad/s")]
    inputs = [Input("joint", "N m"), Input("q", "rad"), Input("v", "rad/s")]
    outputs = [Output("motor", "N m")]
    parameters = [
        Parameter("T", 0.01, unit="s", fixed=True),
        Parameter("J", 0.8, unit="kg m^2", lower=0.05),
        Parameter("b", 1.0, unit="N m s/rad", lower=0.0),
    ]
    ports = [Body("rotor", speed=lambda x, u, p: u.v, position=lambda x, u, p: u.q)]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"lagging": (u.v - x.lagging) / p.T}

    def output(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"motor": u.joint + p.J * (u.v - x.lagging) / p.T + p.b * u.v - port.rotor}
