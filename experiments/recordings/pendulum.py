"""A torque-limited pendulum without its friction, which a diagnosis has to find."""

from __future__ import annotations

from typing import Any

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State


class Pendulum(GreyBoxModel):
    """I d²θ/dt² = τ − m g l sin θ, with θ = 0 hanging.

    Source: F. Wiebe et al., "Torque-limited simple pendulum", Journal of Open Source Software 7, 2022. Published beside it: viscous
    friction 0.0471 N m s/rad, Coulomb friction 0.1839 N m, torque offset −0.0759 N m.
    """

    name = "pendulum"
    states = [State("position", "rad", initial="measured"), State("velocity", "rad/s", initial="measured")]
    inputs = [Input("torque", "N m")]
    outputs = [Output("position", "rad"), Output("velocity", "rad/s")]
    parameters = [
        Parameter("I", 0.15, unit="kg m^2", lower=1e-3, description="moment of inertia"),
        Parameter("mgl", 2.7, unit="N m", lower=0.0, description="gravity torque when level"),
    ]
    ports = [Body("pivot", speed="velocity", position="position")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"position": x.velocity, "velocity": (u.torque - p.mgl * x.position.sin() + port.pivot) / p.I}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"position": x.position, "velocity": x.velocity}
