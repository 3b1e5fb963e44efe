"""A cart with a hanging pole."""

from __future__ import annotations

from typing import Any

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State

GRAVITY = 9.81


class CartWithPole(GreyBoxModel):
    """m x'' + s (θ'' cos θ − θ'² sin θ) = F − f x' and s x'' cos θ + J θ'' + s g sin θ = 0, with θ = 0 hanging.

    m is the mass of cart and pole, s the pole's mass times the distance of its centre, J its inertia about the hinge.
    """

    name = "cart_with_pole"
    states = [
        State("x", "m", initial="measured"),
        State("theta", "rad", initial="measured"),
        State("v", "m/s"),
        State("w", "rad/s"),
    ]
    inputs = [Input("force", "N")]
    outputs = [Output("position", "m"), Output("angle", "rad")]
    parameters = [
        Parameter("m", 1.25, unit="kg", lower=0.01, description="mass of cart and pole"),
        Parameter("s", 0.075, unit="kg m", lower=1e-4, description="first moment of the pole about its hinge"),
        Parameter("J", 0.03, unit="kg m^2", lower=1e-5, description="inertia of the pole about its hinge"),
        Parameter("f", 2.0, unit="N s/m", lower=0.0, description="viscous friction of the cart"),
    ]
    ports = [Body("cart", speed="v", position="x"), Body("pole", speed="w", position="theta")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        cross, sine = p.s * x.theta.cos(), p.s * x.theta.sin()
        along = u.force - p.f * x.v + sine * x.w**2 + port.cart
        about = port.pole - GRAVITY * sine
        whole = p.m * p.J - cross**2
        return {
            "x": x.v,
            "theta": x.w,
            "v": (p.J * along - cross * about) / whole,
            "w": (p.m * about - cross * along) / whole,
        }

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"position": x.x, "angle": x.theta}
