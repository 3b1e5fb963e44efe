"""A speed or a rate that is not that of the position or deflection declared with it is told, with its line."""

from __future__ import annotations

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.checking.examine import examine
from tests.checking.test_coupling_signs import Axis

MOTOR = gt.Body("motor", speed="w_m", position="motor")


def told(*ports: gt.Body | gt.Coupling) -> list[str]:
    """What is found of the axis with these ports."""
    made = type("Bench", (Axis,), {"ports": list(ports), "derivative": _without_ports})
    return [f.found for f in examine(made).findings if "by which its" in f.found]


def _without_ports(self, x, u, p, port):
    own = p.K * (x.motor / 80 - x.link) + p.D * (x.w_m / 80 - x.w_l)
    return {"motor": x.w_m, "w_m": (u.torque - own / 80) / p.J, "link": x.w_l, "w_l": own / p.J}


def gear(deflection, rate) -> gt.Coupling:
    return gt.Coupling("gear", deflection=deflection, rate=rate)


def right(x, u, p):
    return x.motor / 80 - x.link


def rate(x, u, p):
    return x.w_m / 80 - x.w_l


@pytest.mark.parametrize(
    ("port", "odd"),
    [
        (gear(lambda x, u, p: x.link - x.motor / 80, rate), "its rate has the other sign than the rate"),
        (gear(right, lambda x, u, p: x.w_m - x.w_l), "its rate does not depend on the states as the rate does"),
        (gear(right, lambda x, u, p: x.w_m - 80 * x.w_l), "its rate is 80 times the rate"),
        (gt.Body("link", speed="w_l", position="motor"), "its speed does not depend on the states as the rate does"),
        (gt.Body("link", speed="w_l", position=lambda x, u, p: -2 * x.link), "its speed is -0.5 times the rate"),
    ],
)
def test_what_does_not_belong_together_is_told(port: gt.Body | gt.Coupling, odd: str) -> None:
    """Seen: a deflection turned without its rate, a rate without the gear, the position of another body, and "nothing is wrong"."""
    (found,) = told(MOTOR, port)
    assert found.startswith(f"port '{port.name}': {odd}, by which its ")


@pytest.mark.parametrize(
    "port",
    [
        gear(right, rate),
        gt.Body("link", speed="w_l", position=lambda x, u, p: np.degrees(1.0) * x.link),
        gt.Body("link", speed="w_l", position=lambda x, u, p: p.K * x.link),
        gt.Body("link", speed=lambda x, u, p: x.w_l - u.torque, position="link"),
        gt.Body("link", speed="w_l"),
    ],
)
def test_what_belongs_together_is_not(port: gt.Body | gt.Coupling) -> None:
    assert told(MOTOR, port) == []
