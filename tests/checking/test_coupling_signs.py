"""A coupling whose port pushes against the coupling's own force is told, with its line."""

from __future__ import annotations

import pytest
import torch

import greybox_torch as gt


class Axis(gt.GreyBoxModel):
    """A motor and a link on a harmonic drive; the link is lifted against gravity."""

    states = [gt.State("motor", "rad"), gt.State("w_m", "rad/s"), gt.State("link", "rad"), gt.State("w_l", "rad/s")]
    inputs = [gt.Input("torque", "N m")]
    outputs = [gt.Output("motor", "rad")]
    parameters = [
        gt.Parameter("J", 0.01, unit="kg m^2", lower=1e-6),
        gt.Parameter("K", 50.0, unit="N m/rad", lower=0.0),
        gt.Parameter("D", 0.1, unit="N m s/rad", lower=0.0),
        gt.Parameter("m_g_l", 900.0, unit="N m"),
    ]
    ports = [
        gt.Coupling("gear", deflection=lambda x, u, p: x.motor / 80 - x.link, rate=lambda x, u, p: x.w_m / 80 - x.w_l)
    ]
    sign, spring = 1.0, 1.0

    def derivative(self, x, u, p, port):
        own = self.spring * p.K * (x.motor / 80 - x.link) + p.D * (x.w_m / 80 - x.w_l)
        torque = own + self.sign * port.gear
        return {
            "motor": x.w_m,
            "w_m": (u.torque - torque / 80) / p.J,
            "link": x.w_l,
            "w_l": (torque + p.m_g_l * torch.sin(x.link)) / p.J,
        }

    def output(self, x, u, p):
        return {"motor": x.motor}


class Turned(Axis):
    """With - port.gear where the spring's own force has a plus."""

    sign = -1.0


class DampedAlone(Turned):
    """A coupling without a spring."""

    spring = 0.0


class Twisted(gt.GreyBoxModel):
    """The deflection is a state."""

    states = [gt.State("w_m", "rad/s"), gt.State("w_l", "rad/s"), gt.State("twist", "rad")]
    inputs = [gt.Input("torque", "N m")]
    outputs = [gt.Output("w_m", "rad/s")]
    parameters = [gt.Parameter("K", 50.0, unit="N m/rad", lower=0.0)]
    ports = [gt.Coupling("shaft", deflection="twist", rate=lambda x, u, p: x.w_m - x.w_l)]
    sign = 1.0

    def derivative(self, x, u, p, port):
        torque = p.K * x.twist + self.sign * port.shaft
        return {"w_m": u.torque - torque, "w_l": torque, "twist": x.w_m - x.w_l}

    def output(self, x, u, p):
        return {"w_m": x.w_m}


class TwistedAndTurned(Twisted):
    """The same, turned."""

    sign = -1.0


def told(model: gt.GreyBoxModel) -> list[str]:
    found = [f for f in gt.check(model).findings if "own force" in f.found]
    assert all(f.level == "warning" and f.line for f in found)
    return [f.found for f in found]


@pytest.mark.parametrize(
    ("right", "turned", "over"),
    [(Axis, Turned, "deflection"), (Axis, DampedAlone, "rate"), (Twisted, TwistedAndTurned, "deflection")],
)
def test_a_port_that_pushes_against_the_spring(
    right: type[gt.GreyBoxModel], turned: type[gt.GreyBoxModel], over: str
) -> None:
    """Seen: "nothing is wrong", and every law found at the gear would have had the other sign."""
    assert told(right()) == []
    (found,) = told(turned())
    assert f"acts against the coupling's own force, which grows with the {over}" in found
