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


class PublishedPendulum(Pendulum):
    """I d²θ/dt² = τ + τ_0 − m g l sin θ − F_v ω − F_c tanh(ω / ω_0): with the friction and the offset as published (source: see above).

    The published sign of the velocity is smoothed over ω_0 = 0.02 rad/s.
    """

    name = "published_pendulum"
    parameters = [
        *Pendulum.declared_parameters,
        Parameter("F_v", 0.0471, unit="N m s/rad", lower=0.0, description="viscous friction"),
        Parameter("F_c", 0.1839, unit="N m", lower=0.0, description="Coulomb friction"),
        Parameter("offset", -0.0759, unit="N m", description="torque offset"),
    ]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        friction = p.F_v * x.velocity + p.F_c * (x.velocity / 0.02).tanh()
        return super().derivative(x, u, p, port.replaced(pivot=port.pivot + p.offset - friction))
