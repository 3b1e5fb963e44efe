"""Outputs that show a state, by whatever name."""

from __future__ import annotations

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.mechanisms.sensor import SensorBias
from greybox_torch.model.sensed_states import sensed_states


class Axis(GreyBoxModel):
    states = [State("q", "rad", initial="measured"), State("w", "rad/s"), State("twist", "rad")]
    inputs = [Input("torque", "N m")]
    outputs = [Output("encoder", "rad"), Output("w", "rad/s"), Output("scaled", "rad")]
    parameters = [Parameter("J", 0.5)]
    ports = [Body("rotor", speed="w", position="q")]

    def derivative(self, x, u, p, port):
        return {"q": x.w, "w": (u.torque + port.rotor) / p.J, "twist": -x.twist}

    def output(self, x, u, p):
        return {"encoder": x.q, "w": x.w, "scaled": 2.0 * x.twist}


def test_an_output_of_another_name_that_is_the_state_shows_it() -> None:
    assert sensed_states(Axis()) == {"q": "encoder", "w": "w"}


def test_an_effect_at_the_sensor_does_not_hide_the_state() -> None:
    axis = Axis()
    around = {"sensor.encoder": Surroundings({"output": Range(-1.0, 1.0, 0.5)}, {"output": "rad"}, "rad", 0.01)}
    shifted = AugmentedModel(axis, [attach(axis, "sensor.encoder", SensorBias())], around)
    assert sensed_states(shifted) == {"q": "encoder", "w": "w"}
