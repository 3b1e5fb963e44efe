"""A positioning stage: one carriage on a rail, moved by a leadscrew."""

from __future__ import annotations

from typing import Any

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State


class PositioningStage(GreyBoxModel):
    """M d²x/dt² = F − F_v dx/dt."""

    name = "positioning_stage"
    states = [State("position", "m", initial="measured"), State("velocity", "m/s")]
    inputs = [Input("force", "N", description="motor force at the carriage")]
    outputs = [Output("position", "m")]
    parameters = [
        Parameter("M", 20.0, unit="kg", lower=0.1, description="moving mass"),
        Parameter("F_v", 40.0, unit="N s/m", lower=0.0, description="viscous friction"),
    ]
    ports = [Body("carriage", speed="velocity", position="position")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"position": x.velocity, "velocity": (u.force - p.F_v * x.velocity + port.carriage) / p.M}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"position": x.position}
