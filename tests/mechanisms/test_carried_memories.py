"""Which memories begin anew in every window, and which are carried into it."""

from __future__ import annotations

import pytest

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.mechanisms.actuator import InputLag
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.presliding import PreslidingHysteresis
from greybox_torch.mechanisms.sensor import OutputDelay


class Motor(GreyBoxModel):
    states = [State("speed", "rad/s")]
    inputs = [Input("voltage", "V")]
    outputs = [Output("speed", "rad/s")]
    parameters = [Parameter("b", 0.1)]
    ports = [Body("rotor", speed="speed")]

    def derivative(self, x, u, p, port):
        return {"speed": u.voltage - p.b * x.speed + port.rotor}

    def output(self, x, u, p):
        return {"speed": x.speed}


@pytest.mark.parametrize(
    ("port", "law", "carried"),
    [
        ("sensor", OutputDelay(), {"sensor.output_delay.filtered", "sensor.output_delay.slope"}),
        ("rotor", PreslidingHysteresis(), {"rotor.presliding_hysteresis.bristle"}),
        ("actuator", InputLag(), set()),
    ],
)
def test_a_delay_of_the_output_takes_up_no_more_noise_than_one_of_the_input(around, port, law, carried) -> None:
    """Seen, of lags and delays of the input drawn at random: "output delay, 0.93 to 0.97", five times of seven wrong statements."""
    model = Motor()
    augmented = AugmentedModel(model, [Attachment(port, law)], {port: around})
    assert set(augmented.carried_states()) - set(model.carried_states()) == carried
