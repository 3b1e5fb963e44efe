"""A two-link arm that moves in a level plane."""

from __future__ import annotations

from typing import Any

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State


class PlanarArm(GreyBoxModel):
    """M(q2) q'' + C(q, q') = τ − f q', with M11 = a + 2 b cos q2, M12 = d + b cos q2, M22 = d."""

    name = "planar_arm"
    states = [
        State("q1", "rad", initial="measured"),
        State("q2", "rad", initial="measured"),
        State("w1", "rad/s"),
        State("w2", "rad/s"),
    ]
    inputs = [Input("shoulder_torque", "N m"), Input("elbow_torque", "N m")]
    outputs = [Output("shoulder_angle", "rad"), Output("elbow_angle", "rad")]
    parameters = [
        Parameter("a", 0.4, unit="kg m^2", lower=1e-3, description="inertia about the shoulder, arm across"),
        Parameter("b", 0.09, unit="kg m^2", lower=1e-4, description="how that changes with the elbow"),
        Parameter("d", 0.06, unit="kg m^2", lower=1e-4, description="inertia of the outer link about the elbow"),
        Parameter("f1", 0.5, unit="N m s/rad", lower=0.0, description="viscous friction of the shoulder"),
        Parameter("f2", 0.15, unit="N m s/rad", lower=0.0, description="viscous friction of the elbow"),
    ]
    ports = [Body("shoulder", speed="w1", position="q1"), Body("elbow", speed="w2", position="q2")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        cosine, sine = p.b * x.q2.cos(), p.b * x.q2.sin()
        whole, cross = p.a + 2.0 * cosine, p.d + cosine
        first = u.shoulder_torque - p.f1 * x.w1 + sine * (2.0 * x.w1 * x.w2 + x.w2**2) + port.shoulder
        second = u.elbow_torque - p.f2 * x.w2 - sine * x.w1**2 + port.elbow
        size = whole * p.d - cross**2
        return {
            "q1": x.w1,
            "q2": x.w2,
            "w1": (p.d * first - cross * second) / size,
            "w2": (whole * second - cross * first) / size,
        }

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"shoulder_angle": x.q1, "elbow_angle": x.q2}
