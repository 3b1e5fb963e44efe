"""A two-link arm in the plane, once with its mass matrix as textbooks write it and once solved by hand."""

import torch

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State


class TwoLink(GreyBoxModel):
    """M(q) q'' + c(q, q') + g(q) + D q' = τ, with q_2 relative to the first link (Spong, Robot Modeling and Control, ch. 7)."""

    states = [
        State("q1", "rad", initial="measured"),
        State("q2", "rad", initial="measured"),
        State("v1", "rad/s"),
        State("v2", "rad/s"),
    ]
    inputs = [Input("tau1", "N m"), Input("tau2", "N m")]
    outputs = [Output("q1", "rad"), Output("q2", "rad")]
    parameters = [
        Parameter("I1", 0.30, unit="kg m^2", lower=1e-4),
        Parameter("I2", 0.08, unit="kg m^2", lower=1e-4),
        Parameter("h", 0.09, unit="kg m^2"),
        Parameter("g1", 3.0, unit="N m"),
        Parameter("g2", 1.0, unit="N m"),
        Parameter("d1", 0.20, unit="N m s/rad", lower=0.0),
        Parameter("d2", 0.05, unit="N m s/rad", lower=0.0),
    ]
    ports = [Body("shoulder", speed="v1", position="q1"), Body("elbow", speed="v2", position="q2")]

    def derivative(self, x, u, p, port):
        v = torch.stack([x.v1, x.v2], -1)
        cross = p.h * torch.cos(x.q2)
        mass = torch.stack(
            [torch.stack([p.I1 + p.I2 + 2 * cross, p.I2 + cross], -1), torch.stack([p.I2 + cross, p.I2], -1)], -2
        )
        s = p.h * torch.sin(x.q2)
        coriolis = torch.stack(
            [torch.stack([-s * x.v2, -s * (x.v1 + x.v2)], -1), torch.stack([s * x.v1, torch.zeros_like(s)], -1)], -2
        )
        end = p.g2 * torch.sin(x.q1 + x.q2)
        gravity = torch.stack([p.g1 * torch.sin(x.q1) + end, end], -1)
        damping = torch.stack([p.d1 * x.v1, p.d2 * x.v2], -1)
        torque = torch.stack([u.tau1 + port.shoulder, u.tau2 + port.elbow], -1)
        acceleration = torch.linalg.solve(mass, torque - (coriolis @ v.unsqueeze(-1)).squeeze(-1) - gravity - damping)
        a1, a2 = acceleration.unbind(-1)
        return {"q1": x.v1, "q2": x.v2, "v1": a1, "v2": a2}

    def output(self, x, u, p):
        return {"q1": x.q1, "q2": x.q2}


class TwoLinkByHand(TwoLink):
    """The same with the inverse of the mass matrix written out."""

    def derivative(self, x, u, p, port):
        cross, s = p.h * torch.cos(x.q2), p.h * torch.sin(x.q2)
        m11, m12, m22 = p.I1 + p.I2 + 2 * cross, p.I2 + cross, p.I2
        end = p.g2 * torch.sin(x.q1 + x.q2)
        r1 = u.tau1 + port.shoulder + s * x.v2 * (2 * x.v1 + x.v2) - p.g1 * torch.sin(x.q1) - end - p.d1 * x.v1
        r2 = u.tau2 + port.elbow - s * x.v1**2 - end - p.d2 * x.v2
        determinant = m11 * m22 - m12**2
        return {
            "q1": x.v1,
            "q2": x.v2,
            "v1": (m22 * r1 - m12 * r2) / determinant,
            "v2": (m11 * r2 - m12 * r1) / determinant,
        }
