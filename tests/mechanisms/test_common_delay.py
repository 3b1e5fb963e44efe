"""A dead time of all inputs together: what acts, where it is offered, what is stored and exported of it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.screen.candidates import common_delays
from greybox_torch.estimate.problem import make_problem, problem_for
from greybox_torch.exporting.delays import delays_of
from greybox_torch.mechanisms.actuator import InputDelay
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.mechanisms.stored import restored_model, stored_effects
from greybox_torch.model import Body, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import whole_records
from greybox_torch.systems import RobotArm

STEP, LATE = 0.01, 7
AROUND = Surroundings({"input": Range(-2.0, 2.0, 1.0)}, {"input": "N m"}, "N m", STEP)


class TwoDrives(GreyBoxModel):
    """Two motors on one shaft, the second through a gear of three."""

    states = [State("speed", "rad/s", initial=0.0, fixed=True)]
    inputs = [Input("left", "N m"), Input("right", "N m")]
    outputs = [Output("speed", "rad/s")]
    parameters = [Parameter("J", 0.1, lower=0.0), Parameter("b", 0.2, lower=0.0)]
    ports = [Body("shaft", speed="speed")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": (u.left + 3.0 * u.right - p.b * x.speed + port.shaft) / p.J}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": x.speed}


def late() -> AugmentedModel:
    effect = Attachment("actuator.left", InputDelay(["right"]), label="_of_all")
    model = AugmentedModel(TwoDrives(), [effect], {"actuator.left": AROUND})
    model.set_values({"actuator.left.input_delay_of_all.T": LATE * STEP})
    return model


def simulated(data: Any, model: GreyBoxModel) -> np.ndarray:
    problem = make_problem(data, model.plain, data.recordings)
    problem = problem if model is model.plain else problem_for(problem, model, model.values())
    run = Pass(whole_records(problem.records), problem.values, problem.initial)
    return Simulator.of(model).run(problem.driving_records, run).y[0, :, 0]


@pytest.fixture
def inputs() -> dict[str, np.ndarray]:
    rng = np.random.default_rng(2)
    return {name: np.repeat(rng.uniform(-1.0, 1.0, 20), 10) for name in ("left", "right")}


def test_all_inputs_act_late_by_the_same_time(data_set, inputs) -> None:
    def recorded(signals: dict[str, np.ndarray]) -> Any:
        units = {"left": "N m", "right": "N m", "speed": "rad/s"}
        return data_set(units, [{**signals, "speed": np.zeros(200)}], sample_time=STEP)

    shifted = {name: np.concatenate([np.full(LATE, u[0]), u[:-LATE]]) for name, u in inputs.items()}
    np.testing.assert_allclose(
        simulated(recorded(inputs), late()), simulated(recorded(shifted), TwoDrives()), rtol=1e-9, atol=1e-12
    )


def test_it_is_offered_where_there_are_several_inputs() -> None:
    (offered,) = common_delays(TwoDrives())
    assert (offered.port, offered.mechanism.name, offered.mechanism.drives) == (
        "actuator.left",
        "input_delay",
        ("right",),
    )
    assert common_delays(RobotArm()) == []


def test_it_is_stored_and_exported_with_all_inputs() -> None:
    model = late()
    again = restored_model(TwoDrives(), stored_effects(model))
    assert [i.name for i in again.inputs] == [i.name for i in model.inputs]
    assert [(d.input, d.parameter) for d in delays_of(model)] == [(0, 2), (1, 2)]
