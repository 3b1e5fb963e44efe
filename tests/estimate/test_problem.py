"""Problems from a card: what does not fit the model is refused, outputs count by their spread."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greybox_torch.errors import UserError
from greybox_torch.estimate.fit import fit_records
from greybox_torch.model import GreyBoxModel, Input, Output, Parameter, State
from tests.estimate.bench_motor import UNITS, problem_of, values


class Double(GreyBoxModel):
    """The motor with its angle as a second output, in a much smaller unit."""

    states = [State("speed", "rad/s", initial="measured"), State("angle", "rev")]
    inputs = [Input("voltage", "V")]
    outputs = [Output("speed", "rad/s"), Output("angle", "rev")]
    parameters = [Parameter("T", 0.3, unit="s", lower=0.0), Parameter("turn", 5.0, unit="rad/rev")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": (2.0 * u.voltage - x.speed) / p.T, "angle": x.speed / p.turn}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": x.speed, "angle": x.angle}


def test_outputs_in_different_units_count_alike(motor_speed: Any, data_set: Any) -> None:
    rng = np.random.default_rng(2)
    voltage = np.repeat(rng.uniform(-5, 5, 30), 20)
    speed = motor_speed(voltage)
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * 0.01)]) / (2 * np.pi)
    units = {"voltage": "V", "speed": "rad/s", "angle": "rev"}
    data = data_set(units, [{"voltage": voltage, "speed": speed, "angle": angle}])
    problem = problem_of(data, Double())
    np.testing.assert_allclose(problem.weights, [1 / speed.std(), 1 / angle.std()])
    found = fit_records(problem)
    assert values(found) == pytest.approx({"T": 0.4, "turn": 2 * np.pi}, rel=1e-3)
    assert found.samples == 1200


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            {"parameters": {"Jay": {"value": 1.0}}},
            r"dataset.toml: \[model.parameters\] Jay: model Motor has no such name",
        ),
        (
            {"parameters": {"J": {"value": -1.0}}},
            r"\[model.parameters\] Parameter 'J': value -1 lies outside its bounds",
        ),
        ({"parameters": {"J": {"upper": 0.001}}}, r"'J': value 0.01 lies outside its bounds \[0, 0.001\]"),
        ({"initial": {"SPEED": {"value": 1.0}}}, r'SPEED: .*did you mean "speed"'),
        ({"initial": {"sped": {"value": 1.0}}}, r'\[model.initial\] sped: .*did you mean "speed"'),
    ],
)
def test_cards_that_do_not_fit_the_model(
    motor: GreyBoxModel, experiments: list[Any], data_set: Any, options: Any, message: str
) -> None:
    with pytest.raises(UserError, match=message):
        problem_of(data_set(UNITS, experiments, **options), motor)
