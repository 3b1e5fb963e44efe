"""The Silverbox with a linear spring: a diagnosis has to find that it stiffens."""

from __future__ import annotations

from typing import Any

from greybox_torch import Body, Coupling, GreyBoxModel, Input, Output, Parameter, State


class Silverbox(GreyBoxModel):
    """d²y/dt² = b (u + u_0) − k y − d dy/dt, measured with an offset y_0.

    Source: T. Wigren and J. Schoukens, "Three free data sets for development and benchmarking in nonlinear system identification",
    European Control Conference, Zurich, 2013. An electronic circuit that behaves as a mass on a spring with a cubic term.
    """

    name = "silverbox"
    states = [State("deflection", "V", initial="measured"), State("rate", "V/s")]
    inputs = [Input("force", "V")]
    outputs = [Output("deflection", "V")]
    parameters = [
        Parameter("k", 1.8e5, unit="1/s^2", lower=0.0, description="stiffness by mass"),
        Parameter("d", 50.0, unit="1/s", lower=0.0, description="damping by mass"),
        Parameter("b", 1.0e5, unit="1/s^2", lower=0.0, description="input gain by mass"),
        Parameter("u_0", 0.0, unit="V", description="offset of the input"),
        Parameter("y_0", 0.0, unit="V", description="offset of the output"),
    ]
    ports = [
        Body("mass", speed="rate", position="deflection"),
        Coupling("spring", deflection="deflection", rate="rate"),
    ]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        force = p.b * (u.force + p.u_0)
        return {"deflection": x.rate, "rate": force - p.k * x.deflection - p.d * x.rate - port.spring + port.mass}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"deflection": x.deflection + p.y_0}


class PublishedSilverbox(Silverbox):
    """d²y/dt² = b (u + u_0) − k y − k_3 y³ − d dy/dt: with the cubic term of the spring that the circuit was built for (source: see above).

    The source gives the form of the equation but no values: k_3 starts where the other start values make it matter.
    """

    name = "published_silverbox"
    parameters = [
        *Silverbox.declared_parameters,
        Parameter("k_3", 5e5, unit="1/(s V)^2", description="cubic stiffness by mass"),
    ]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return super().derivative(x, u, p, port.replaced(spring=port.spring + p.k_3 * x.deflection**3))
