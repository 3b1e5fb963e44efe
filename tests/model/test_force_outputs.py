"""Outputs that are forces: what acts at a port is seen in them at once."""

from __future__ import annotations

import numpy as np
import pytest
import torch

import greybox_torch as gt
from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.sensor import SensorLag
from greybox_torch.mechanisms.surroundings import Range, Surroundings
from greybox_torch.simulation.packed_normals import PackedNormals


class Turned(GreyBoxModel):
    """The speed is given, the torque is measured."""

    states = [State("clock", "s", initial=0.0, fixed=True)]
    inputs = [Input("speed", "rad/s")]
    outputs = [Output("torque", "N m")]
    parameters = [Parameter("b", 0.5, unit="N m s/rad", lower=0.0)]
    ports = [Body("shaft", speed=lambda x, u, p: u.speed)]

    def derivative(self, x, u, p, port):
        return {"clock": 1.0 + 0.0 * x.clock}

    def output(self, x, u, p, port):
        return {"torque": p.b * u.speed - port.shaft}


class Plain(Turned):
    def output(self, x, u, p):
        return {"torque": p.b * u.speed}


AROUND = {
    "shaft": Surroundings({"speed": Range(-2.0, 2.0, 1.0)}, {"speed": "rad/s"}, "N m", 0.1),
    "sensor": Surroundings({"output": Range(-2.0, 2.0, 1.0)}, {"output": "N m"}, "N m", 0.1),
}


def with_friction(base: GreyBoxModel, *more: Attachment) -> AugmentedModel:
    start = {"shaft.coulomb_friction.F_c": 0.3, "shaft.coulomb_friction.v_0": 0.01}
    return AugmentedModel(base, [Attachment("shaft", CoulombFriction()), *more], AROUND, start=start)


def measured(model: GreyBoxModel, speed: list[float]) -> np.ndarray:
    x = torch.zeros(len(model.states), len(speed), dtype=torch.float64)
    return model.measured(x, torch.tensor([speed], dtype=torch.float64), model.physical()).detach().numpy()[0]


def test_which_models_ask_for_the_forces() -> None:
    assert Turned.asks_for_forces
    assert not Plain.asks_for_forces


def test_friction_shows_in_the_torque_at_once_with_the_sign_of_the_motion() -> None:
    assert measured(Turned(), [1.0, -2.0]) == pytest.approx([0.5, -1.0])
    assert measured(with_friction(Turned()), [1.0, -2.0]) == pytest.approx([0.8, -1.3])


def test_an_output_that_does_not_ask_for_forces_shows_none() -> None:
    assert measured(with_friction(Plain()), [1.0, -2.0]) == pytest.approx([0.5, -1.0])


def test_a_lag_of_the_sensor_follows_the_torque_with_the_friction_in_it() -> None:
    model = with_friction(Turned(), Attachment("sensor", SensorLag()))
    x = torch.zeros(len(model.states), 1, dtype=torch.float64)
    before = model.rates(x, torch.tensor([[1.0]], dtype=torch.float64), model.physical())[-1]
    without = AugmentedModel(Turned(), [Attachment("sensor", SensorLag())], AROUND)
    alone = without.rates(x[-2:], torch.tensor([[1.0]], dtype=torch.float64), without.physical())[-1]
    assert float(before.detach() / alone.detach()) == pytest.approx(0.8 / 0.5)


def test_a_friction_is_estimated_from_the_torque_under_a_prescribed_motion() -> None:
    draw = np.random.default_rng(0)
    speed = np.repeat(draw.uniform(-2.0, 2.0, 200), 2)
    torque = 0.7 * speed + 0.4 * np.tanh(speed / 0.01)
    data = gt.DataSet(
        [gt.Recording.from_arrays("steps", {"speed": speed, "torque": torque}, sample_time=0.1)],
        hold="zoh",
        name="Shaft",
    )
    fitted = gt.fit(with_friction(Turned()), data).parameters
    assert fitted["b"].value == pytest.approx(0.7, rel=1e-3)
    assert fitted["shaft.coulomb_friction.F_c"].value == pytest.approx(0.4, rel=1e-3)


def test_no_rows_of_packed_matrices_are_no_rows() -> None:
    packed = PackedNormals.whole(np.ones((3, 4, 4, 2)), 5)
    assert packed.rows(np.arange(0)).shape == (5, 0, 4)
