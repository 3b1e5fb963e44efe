"""A motor, an elastic gear and a drum, of which the model does not tell what the gear carries."""

from __future__ import annotations

from typing import Any

from greybox_torch.model import Body, Coupling, GreyBoxModel, Input, Output, Parameter, State


class GearedDrum(GreyBoxModel):
    states = [State("motor", "rad"), State("drum", "rad"), State("w_m", "rad/s"), State("w_d", "rad/s")]
    inputs = [Input("torque", "N m")]
    outputs = [Output("motor", "rad"), Output("drum", "rad")]
    parameters = [
        Parameter("J_m", 0.001, "kg m^2"),
        Parameter("J_d", 0.1, "kg m^2"),
        Parameter("k", 3000.0, "N m/rad"),
        Parameter("k_3", 1e7, "N m/rad^3"),
        Parameter("c", 2.0, "N m s/rad"),
        Parameter("b", 0.05, "N m s/rad"),
        Parameter("N", 5.0, fixed=True),
    ]
    ports = [
        Body("motor_shaft", speed="w_m", position="motor"),
        Body("drum", speed="w_d", position="drum"),
        Coupling(
            "gear",
            deflection=lambda x, u, p: x.motor / p.N - x.drum,
            rate=lambda x, u, p: x.w_m / p.N - x.w_d,
        ),
    ]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        twist = x.motor / p.N - x.drum
        carried = p.k * twist + p.k_3 * twist**3 + p.c * (x.w_m / p.N - x.w_d) + port.gear
        return {
            "motor": x.w_m,
            "drum": x.w_d,
            "w_m": (u.torque - carried / p.N + port.motor_shaft) / p.J_m,
            "w_d": (carried - p.b * x.w_d + port.drum) / p.J_d,
        }

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"motor": x.motor, "drum": x.drum}
