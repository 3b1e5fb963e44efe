"""The slowest time constant of a machine by its model."""

from __future__ import annotations

import numpy as np
import pytest
import torch

import greybox_torch as gt
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.slowest_time_constant import slowest_time_constant
from tests.checking.test_short_records import CONSTANT, Plate, data

DAMPER, MASS, SPRING = 4.0, 1.0, 4.0
"""Of a carriage whose pole is double without dry friction, of 0.5 s."""


class Carriage(gt.GreyBoxModel):
    """A carriage on a spring, with drag and rounded dry friction, whose position is measured."""

    states = (gt.State("q", "m", initial="measured"), gt.State("v", "m/s"))
    inputs = (gt.Input("F", "N"),)
    outputs = (gt.Output("q", "m"),)
    parameters = (gt.Parameter("F_c", 1.0, unit="N"),)

    def derivative(self, x, u, p, port):
        friction = DAMPER * x.v + p.F_c * torch.tanh(x.v / 0.001)
        return {"q": x.v, "v": (u.F - SPRING * x.q - friction + self.pushed(port)) / MASS}

    def pushed(self, port):
        return 0.0

    def output(self, x, u, p):
        return {"q": x.q}


class OnRail(Carriage):
    """The same, with its body declared."""

    ports = (gt.Body("carriage", speed="v", position="q"),)

    def pushed(self, port):
        return port.carriage


class Drive(gt.GreyBoxModel):
    """A drive against a spring, with rounded dry friction and without ports, whose speed is measured."""

    states = (gt.State("w", "rad/s", initial="measured"), gt.State("q", "rad"))
    inputs = (gt.Input("torque", "N m"),)
    outputs = (gt.Output("w", "rad/s"),)
    parameters = (gt.Parameter("F_c", 1.0, unit="N m"),)

    def derivative(self, x, u, p, port):
        return {"w": u.torque - 4.0 * x.q - 4.0 * x.w - p.F_c * torch.tanh(x.w / 0.001), "q": x.w}

    def output(self, x, u, p):
        return {"w": x.w}


def of(model: gt.GreyBoxModel, channels: tuple[str, str]) -> float | None:
    """Of a model, on a recording that begins at rest."""
    time = 0.01 * np.arange(400)
    moved = np.maximum(time - 0.5, 0.0)
    signals = {channels[0]: np.zeros(400), channels[1]: np.sin(moved)}
    run = gt.Recording.from_arrays("run", signals, sample_time=0.01)
    return slowest_time_constant(model, make_problem(gt.DataSet([run], held_out_by_default=False), model, [run]))


def test_of_a_linear_model() -> None:
    recordings = data(600.0, 80.0)
    problem = make_problem(recordings, Plate(), recordings.estimation())
    assert slowest_time_constant(Plate(), problem) == pytest.approx(CONSTANT)


def test_dry_friction_at_rest_is_no_slow_pole() -> None:
    """Seen: 250 s of a drive whose motion takes half a second: at rest its rounded friction is a damper of 1000 N m s/rad."""
    assert of(Drive(), ("torque", "w")) == pytest.approx(0.5, rel=1e-3)


def test_of_a_body_with_dry_friction_none_is_known() -> None:
    smooth, rough = OnRail(), OnRail()
    smooth.set_values({"F_c": 0.0})
    assert of(rough, ("F", "q")) is None
    assert of(smooth, ("F", "q")) == pytest.approx(0.5, rel=1e-3)
