"""A coupling whose port drives its deflection on is told, with its line."""

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


class Joint(gt.GreyBoxModel):
    """A pendulum that gravity tips over, on a joint without a force of its own; the arm that it hangs on may be driven."""

    states = [gt.State("q", "rad"), gt.State("w", "rad/s")]
    inputs = [gt.Input("torque", "N m")]
    outputs = [gt.Output("q", "rad")]
    parameters = [
        gt.Parameter("J", 1.0, unit="kg m^2", lower=1e-6),
        gt.Parameter("m_g_l", 9.0, unit="N m/rad", lower=0.0),
    ]
    ports = [gt.Coupling("joint", deflection="q", rate="w")]
    sign = -1.0

    def derivative(self, x, u, p, port):
        return {"q": x.w, "w": (u.torque + p.m_g_l * x.q + self.sign * port.joint) / p.J}

    def output(self, x, u, p):
        return {"q": x.q}


class JointTurned(Joint):
    """The same, turned."""

    sign = 1.0


class Belt(gt.GreyBoxModel):
    """Two masses on a belt without a law, one of which a spring at the other one's position pushes."""

    states = [gt.State("q1", "m"), gt.State("v1", "m/s"), gt.State("q2", "m"), gt.State("v2", "m/s")]
    inputs, outputs = [gt.Input("u", "N")], [gt.Output("q1", "m")]
    parameters = [gt.Parameter("m", 1.0, unit="kg", lower=1e-6), gt.Parameter("k", 5.0, unit="N/m", lower=0.0)]
    ports = [gt.Coupling("belt", deflection=lambda x, u, p: x.q1 - x.q2, rate=lambda x, u, p: x.v1 - x.v2)]
    sign = 1.0

    def derivative(self, x, u, p, port):
        belt = self.sign * port.belt
        return {"q1": x.v1, "v1": (u.u - p.k * x.q2 - belt) / p.m, "q2": x.v2, "v2": belt / p.m}

    def output(self, x, u, p):
        return {"q1": x.q1}


class BeltTurned(Belt):
    """The same, turned."""

    sign = -1.0


class Massless(gt.GreyBoxModel):
    """A spring against a damper, without a mass."""

    states = [gt.State("q", "m")]
    inputs, outputs = [gt.Input("u", "N")], [gt.Output("q", "m")]
    parameters = [gt.Parameter("d", 1.0, unit="N s/m", lower=1e-6)]
    ports = [gt.Coupling("spring", deflection="q", rate=lambda x, u, p: u.u / p.d)]
    sign = -1.0

    def derivative(self, x, u, p, port):
        return {"q": (u.u + self.sign * port.spring) / p.d}

    def output(self, x, u, p):
        return {"q": x.q}


class MasslessTurned(Massless):
    """The same, turned."""

    sign = 1.0


def told(model: gt.GreyBoxModel) -> list[str]:
    found = [f for f in gt.check(model).findings if "wrong sign" in f.found]
    assert all(f.level == "warning" and f.line for f in found)
    return [f.found for f in found]


@pytest.mark.parametrize(
    ("right", "turned", "over"),
    [
        (Axis, Turned, "rate"),
        (Axis, DampedAlone, "rate"),
        (Twisted, TwistedAndTurned, "rate"),
        (Joint, JointTurned, "rate"),
        (Belt, BeltTurned, "rate"),
        (Massless, MasslessTurned, "deflection"),
    ],
)
def test_a_port_that_drives_the_deflection_on(
    right: type[gt.GreyBoxModel], turned: type[gt.GreyBoxModel], over: str
) -> None:
    """Seen: "nothing is wrong", and every law found at the gear would have had the other sign; and of a joint without a force of its own,
    or one softer than gravity, that its right sign was wrong.
    """
    assert told(right()) == []
    (found,) = told(turned())
    assert f"a force there drives the {over} on" in found
