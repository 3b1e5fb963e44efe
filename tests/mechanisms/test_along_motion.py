"""Curves over an input along a body's motion: what a gear loses by whether its motor drives or brakes."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import pytest
import torch

import greybox_torch as gt
from greybox_torch.diagnosis.describe.signal_names import signal_name
from greybox_torch.diagnosis.screen.candidates import candidates
from greybox_torch.errors import UserError
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.surroundings import surroundings_along
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.surroundings import Surroundings
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Body, GreyBoxModel, Input, Output, Parameter, Signals, State
from greybox_torch.model.along_motion import direction, inputs_that_push


class Hoist(GreyBoxModel):
    """A motor and, by a rope without mass, what hangs there; the wind pushes the load alone."""

    states: ClassVar = [State("motor", "rad/s"), State("load", "rad/s")]
    inputs: ClassVar = [Input("torque", "N m"), Input("wind", "N m")]
    outputs: ClassVar = [Output("motor", "rad/s"), Output("load", "rad/s")]
    parameters: ClassVar = [Parameter("J", 2.0, unit="kg m^2")]
    ports: ClassVar = [
        Body("winch", speed="motor"),
        Body("hook", speed="load"),
        Body("both", speed=lambda x, u, p: 0.5 * (x.motor + x.load)),
    ]

    def derivative(self, x, u, p, port):
        rope = x.motor - x.load
        return {
            "motor": (u.torque - rope + port.winch + port.both) / p.J,
            "load": rope + 0.5 * u.wind + port.hook + port.both,
        }

    def output(self, x, u, p):
        return {"motor": x.motor, "load": x.load}


CURVE = Unknown("along@torque", 30, "direction@winch")


@pytest.fixture(scope="module")
def around() -> dict[str, Surroundings]:
    wave = np.sin(np.arange(400.0) / 9)
    names = ("torque", "wind", "motor", "load")
    recording = gt.Recording.from_arrays("run", dict.fromkeys(names, 3.0 * wave), sample_time=0.01)
    problem = make_problem(gt.DataSet([recording]), Hoist(), (recording,))
    count = problem.records.u.shape[1]
    return surroundings_along(Hoist(), problem, np.outer(np.cos(np.arange(count) / 9), [5.0, 4.0]))


def test_the_inputs_that_push_a_body_are_those_that_its_speed_answers_to() -> None:
    assert inputs_that_push(Hoist()) == {"winch": ["torque"], "hook": ["wind"], "both": []}


def test_the_direction_changes_about_rest() -> None:
    np.testing.assert_allclose(direction(np.array([-5.0, 0.0, 5.0]), 4.0), [-1.0, 0.0, 1.0], atol=1e-12)
    assert 0.0 < float(direction(0.04, 4.0)) < 0.9


def test_it_is_offered_where_an_input_pushes(around) -> None:
    found = candidates(Hoist(), {}, around, flexible=True)
    curves = {(a.port, *a.mechanism.signals()) for a in found if a.mechanism.name == "unknown"}
    assert {c for c in curves if "along@" in c[1]} == {
        ("winch", "along@torque", "direction@winch"),
        ("hook", "along@wind", "direction@hook"),
    }
    fine = candidates(Hoist(), {}, around, flexible=True, knots=40)
    assert not [a for a in fine if "along@" in str(a.mechanism.signals())]
    ranges, units = around["winch"].ranges, around["winch"].units
    assert (ranges["along@torque"].low, ranges["along@torque"].high) == pytest.approx((-3.0, 3.0), abs=0.01)
    assert units["along@torque"] == "N m" and "along@wind" not in ranges
    winch = Hoist.ports[0]
    assert signal_name(Hoist(), winch, "along@torque") == "torque along the motion"
    assert signal_name(Hoist(), winch, "direction@winch") == "direction of motor"


@pytest.mark.parametrize(("torque", "speed"), [(1.0, 3.0), (-1.0, 3.0), (1.0, -3.0), (-1.0, -3.0)])
def test_a_gear_loses_a_part_of_what_drives_and_adds_to_what_brakes(around, torque: float, speed: float) -> None:
    """A fifth is lost where the motor drives; where it brakes the gear brakes a tenth more: against the motion both times."""
    hoist = Hoist()
    curve = attach(hoist, "winch", CURVE)
    model = AugmentedModel(hoist, [curve], around)
    centres = np.array(CURVE.centres(around["winch"]))
    loss = -np.where(centres > 0, 0.2, -0.1) * centres / np.sqrt(np.pi)
    told = {q.name: q.value for q in model.declared_parameters}
    told |= {f"winch.unknown.w_{k}": height for k, height in enumerate(loss)}
    p = Signals("parameter", {n: torch.tensor(v, dtype=torch.float64) for n, v in told.items()})
    zero = torch.zeros((), dtype=torch.float64)
    x = Signals("state", {"motor": zero + speed, "load": zero + speed})
    u = Signals("input", {"torque": zero + torque, "wind": zero})
    none = Signals("port", dict.fromkeys((q.name for q in hoist.all_ports), zero))
    force = 2.0 * float(model.derivative(x, u, p, none)["motor"]) - torque
    assert force == pytest.approx(-np.sign(speed) * (0.2 if torque * speed > 0 else 0.1), rel=0.02)


def test_an_input_that_is_not_there_is_named(around) -> None:
    hoist = Hoist()
    with pytest.raises(
        UserError, match=r"no input 'brake', which the effect at 'winch' depends on \(it has: torque, wind\)"
    ):
        AugmentedModel(hoist, [attach(hoist, "winch", Unknown("along@brake", 6, "direction@winch"))], around)
