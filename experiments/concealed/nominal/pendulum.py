"""A driven pendulum."""

from __future__ import annotations

from typing import Any

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State


class Pendulum(GreyBoxModel):
    """I d²θ/dt² = τ − b dθ/dt − m g l sin θ, with θ = 0 hanging.

    The pivot carries the rod's pull: m g l cos θ + I (dθ/dt)², by the rod's length.
    """

    name = "pendulum"
    states = [State("angle", "rad", initial="measured"), State("speed", "rad/s", initial="measured")]
    inputs = [Input("torque", "N m")]
    outputs = [Output("angle", "rad"), Output("speed", "rad/s")]
    parameters = [
        Parameter("I", 0.15, unit="kg m^2", lower=1e-3, description="moment of inertia"),
        Parameter("mgl", 2.7, unit="N m", lower=0.0, description="gravity torque when level"),
        Parameter("b", 0.05, unit="N m s/rad", lower=0.0, description="viscous friction"),
    ]
    ports = [
        Body(
            "pivot",
            speed="speed",
            position="angle",
            load=lambda x, u, p: p.mgl * x.angle.cos() + p.I * x.speed**2,
        )
    ]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        torque = u.torque - p.b * x.speed - p.mgl * x.angle.sin() + port.pivot
        return {"angle": x.speed, "speed": torque / p.I}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"angle": x.angle, "speed": x.speed}
