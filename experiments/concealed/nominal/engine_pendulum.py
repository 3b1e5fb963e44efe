"""A pendulum on a motor."""

from __future__ import annotations

from typing import Any

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State


class DrivenPendulum(GreyBoxModel):
    """J d²θ/dt² = τ − mgl sin θ − d dθ/dt, with θ = 0 hanging."""

    name = "driven_pendulum"
    states = [State("angle", "rad", initial="measured"), State("speed", "rad/s", initial="measured")]
    inputs = [Input("torque", "N m")]
    outputs = [Output("angle", "rad"), Output("speed", "rad/s")]
    parameters = [
        Parameter("J", 0.12, unit="kg m^2", lower=1e-4, description="moment of inertia about the pivot"),
        Parameter("mgl", 2.5, unit="N m", lower=0.0, description="gravity torque when level"),
        Parameter("d", 0.03, unit="N m s/rad", lower=0.0, description="viscous friction of the joint"),
    ]
    ports = [Body("pivot", speed="speed", position="angle")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        torque = u.torque - p.mgl * x.angle.sin() - p.d * x.speed + port.pivot
        return {"angle": x.speed, "speed": torque / p.J}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"angle": x.angle, "speed": x.speed}
