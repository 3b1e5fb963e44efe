"""The electro-mechanical positioning system EMPS without its Coulomb friction and its offset, which a diagnosis has to find."""

from __future__ import annotations

from typing import Any

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State


class PositioningStage(GreyBoxModel):
    """M d²x/dt² = F − F_v dx/dt.

    Source: A. Janot, M. Gautier and M. Brunot, "Data set and reference models of EMPS", Workshop on Nonlinear System Identification
    Benchmarks, Eindhoven, 2019. Their model has Coulomb friction (20.39 N) and an offset (−3.16 N) besides; M 95.11 kg, F_v 203.5 N s/m.
    """

    name = "positioning_stage"
    states = [State("position", "m", initial="measured"), State("velocity", "m/s")]
    inputs = [Input("force", "N", description="motor force")]
    outputs = [Output("position", "m")]
    parameters = [
        Parameter("M", 100.0, unit="kg", lower=1.0, description="moving mass, seen from the carriage"),
        Parameter("F_v", 200.0, unit="N s/m", lower=0.0, description="viscous friction"),
    ]
    ports = [Body("carriage", speed="velocity", position="position")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"position": x.velocity, "velocity": (u.force - p.F_v * x.velocity + port.carriage) / p.M}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"position": x.position}


class PublishedPositioningStage(PositioningStage):
    """M d²x/dt² = F − F_v v − F_c tanh(v / v_0) − offset: the published model (source: see above), its sign smoothed over v_0 = 1 mm/s."""

    name = "published_positioning_stage"
    parameters = [
        *PositioningStage.declared_parameters,
        Parameter("F_c", 20.3935, unit="N", lower=0.0, description="Coulomb friction"),
        Parameter("offset", -3.1648, unit="N", description="constant force against the motor"),
    ]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        friction = p.F_c * (x.velocity / 1e-3).tanh() + p.offset
        return super().derivative(x, u, p, port.replaced(carriage=port.carriage - friction))
