"""Attachments to JSON and back."""

from __future__ import annotations

import json

import numpy as np
import pytest

from greybox_torch.errors import UserError
from greybox_torch.mechanisms.actuator import InputDelay
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.presliding import PreslidingHysteresis
from greybox_torch.mechanisms.stored import attachment_json, restored_model
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.mechanisms.transmission import Backlash
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.windows import Windows
from greybox_torch.systems import RobotArm


def effects():
    arm = RobotArm()
    return [
        attach(arm, "gear_spring", Backlash(), "+gear_twist"),
        attach(arm, "motor", TorqueRipple(7.3)),
        attach(arm, "motor", Unknown("position", knots=6)),
        attach(arm, "motor", PreslidingHysteresis()),
        attach(arm, "actuator", InputDelay()),
    ]


def test_round_trip_gives_the_same_simulation(arm_search) -> None:
    around, records = arm_search.surroundings, arm_search.problem.records
    model = AugmentedModel(RobotArm(), effects(), around)
    entries = json.loads(json.dumps([attachment_json(e, around[e.port]) for e in effects()]))
    again = restored_model(RobotArm(), entries)
    assert again.declared_parameters == model.declared_parameters
    assert (again.states, again.inputs) == (model.states, model.inputs)
    rng = np.random.default_rng(0)
    p = np.array([v + 0.01 * rng.uniform() for v in model.values().values()])
    x0, windows = 0.01 * rng.normal(size=(1, len(model.states))), Windows(np.array([0]), np.array([19]), 20)
    one, other = (
        EagerStepper.of(m, (), "cpu", "double").run(m.prepared(records, p), Pass(windows, p, x0)).y
        for m in (model, again)
    )
    assert np.array_equal(one, other) and np.ptp(one) > 0


def test_mechanism_that_is_not_there(arm_search) -> None:
    entry = attachment_json(effects()[0], arm_search.surroundings["gear_spring"]) | {"mechanism": "magic"}
    with pytest.raises(UserError, match="mechanism 'magic' is not in the library; expected one of viscous_friction, "):
        restored_model(RobotArm(), [entry])


def test_port_that_is_not_there(arm_search, motor) -> None:
    entry = attachment_json(effects()[1], arm_search.surroundings["motor"])
    with pytest.raises(UserError, match="model Motor has no port 'motor'"):
        restored_model(motor, [entry])
