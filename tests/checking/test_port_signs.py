"""A body or a balance whose port acts the wrong way is told, with its line."""

from __future__ import annotations

import pytest
import torch

import greybox_torch as gt


class Cart(gt.GreyBoxModel):
    """A motor that draws a carriage over a stiff belt; the carriage's port may be written as a force against it."""

    states = [gt.State("speed", "rad/s"), gt.State("place", "m"), gt.State("v", "m/s")]
    inputs, outputs = [gt.Input("torque", "N m")], [gt.Output("place", "m")]
    parameters = [
        gt.Parameter("m", 8.0, unit="kg", lower=0.1),
        gt.Parameter("r", 0.03, unit="m", fixed=True),
        gt.Parameter("d", 50.0, unit="N s/m", lower=0.0),
    ]
    ports = [gt.Body("carriage", speed="v", position="place")]
    sign = 1.0

    def derivative(self, x, u, p, port):
        belt = p.d * (p.r * x.speed - x.v)
        return {"speed": u.torque - p.r * belt, "place": x.v, "v": (belt + self.sign * port.carriage) / p.m}

    def output(self, x, u, p):
        return {"place": x.place}


class CartTurned(Cart):
    """The same, turned."""

    sign = -1.0


class CartBackwards(Cart):
    """Nothing is turned but what is called forward."""

    ports = [gt.Body("carriage", speed=lambda x, u, p: -x.v, position=lambda x, u, p: -x.place)]
    sign = -1.0


class CartBackwardsTurned(CartBackwards):
    """The same, turned."""

    sign = 1.0


class Dashpot(gt.GreyBoxModel):
    """A body without a mass: a force moves it at once."""

    states = [gt.State("q", "m")]
    inputs, outputs = [gt.Input("u", "N")], [gt.Output("q", "m")]
    parameters = [gt.Parameter("d", 1.0, unit="N s/m", lower=1e-6)]
    ports = [gt.Body("piston", speed=lambda x, u, p: u.u / p.d, position="q")]
    sign = 1.0

    def derivative(self, x, u, p, port):
        return {"q": (u.u + self.sign * port.piston) / p.d}

    def output(self, x, u, p):
        return {"q": x.q}


class DashpotTurned(Dashpot):
    """The same, turned."""

    sign = -1.0


class Arm(gt.GreyBoxModel):
    """Two links that move one another: joint torques through a mass matrix."""

    states = [gt.State("q1", "rad"), gt.State("q2", "rad"), gt.State("v1", "rad/s"), gt.State("v2", "rad/s")]
    inputs, outputs = [gt.Input("torque", "N m")], [gt.Output("q1", "rad"), gt.Output("q2", "rad")]
    parameters = [gt.Parameter("J", 1.0, unit="kg m^2", lower=1e-6)]
    ports = [gt.Body("shoulder", speed="v1", position="q1"), gt.Body("elbow", speed="v2", position="q2")]
    sign = 1.0

    def derivative(self, x, u, p, port):
        c = p.J * torch.cos(x.q2)
        a, b, d = 3.0 * p.J + 2.0 * c, p.J + c, p.J
        one, two = u.torque + port.shoulder, self.sign * port.elbow
        det = a * d - b * b
        return {"q1": x.v1, "q2": x.v2, "v1": (d * one - b * two) / det, "v2": (a * two - b * one) / det}

    def output(self, x, u, p):
        return {"q1": x.q1, "q2": x.q2}


class ArmTurned(Arm):
    """With the elbow's torque turned."""

    sign = -1.0


class Vessel(gt.GreyBoxModel):
    """A balance of heat."""

    states, inputs, outputs = [gt.State("T", "degC")], [gt.Input("heat", "W")], [gt.Output("T", "degC")]
    parameters = [gt.Parameter("C", 1e5, unit="J/K", lower=1.0)]
    ports = [gt.Balance("vessel", level="T")]
    sign = 1.0

    def derivative(self, x, u, p, port):
        return {"T": (u.heat + self.sign * port.vessel) / p.C}

    def output(self, x, u, p):
        return {"T": x.T}


class VesselTurned(Vessel):
    """The same, turned."""

    sign = -1.0


class Exchanger(VesselTurned):
    """What goes through a wall, in the direction given, levels the difference: no fault."""

    ports = [gt.Balance("vessel", level=lambda x, u, p: x.T - u.heat)]


def told(model: gt.GreyBoxModel) -> list[str]:
    found = [f for f in gt.check(model).findings if "wrong sign" in f.found]
    assert all(f.level == "warning" and f.line for f in found)
    return [f.found for f in found]


@pytest.mark.parametrize(
    ("right", "turned", "lowered"),
    [
        (Cart, CartTurned, "speed"),
        (CartBackwards, CartBackwardsTurned, "speed"),
        (Dashpot, DashpotTurned, "position"),
        (Arm, ArmTurned, "speed"),
        (Vessel, VesselTurned, "level"),
    ],
)
def test_a_port_that_lowers_what_it_raises(
    right: type[gt.GreyBoxModel], turned: type[gt.GreyBoxModel], lowered: str
) -> None:
    """Seen: `- port.carriage`, "nothing is wrong", and an unknown effect (0.97) in the place of the carriage's friction."""
    assert told(right()) == []
    (found,) = told(turned())
    assert f"lowers the {lowered}" in found


def test_what_goes_through_a_wall_levels_a_difference() -> None:
    assert told(Exchanger()) == []


def test_a_negative_mass_is_no_turned_port() -> None:
    class Light(Cart):
        """What is wrong there is told by itself."""

        parameters = [
            gt.Parameter("m", -8.0, unit="kg"),
            gt.Parameter("r", 0.03, unit="m"),
            gt.Parameter("d", 50.0, unit="N s/m"),
        ]

    class LightTurned(Light):
        """Seen: one negative mass, and no port of the model was looked at."""

        sign = -1.0

    assert told(Light()) == [] and len(told(LightTurned())) == 1
    assert any("negative mass" in f.found for f in gt.check(Light()).findings)
