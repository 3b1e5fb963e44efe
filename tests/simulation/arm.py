"""The arm on which steppers are tried: its records, its compiled stepper, and an oscillator whose solution is known."""

from __future__ import annotations

from typing import Any

import numpy as np

from greybox_torch.model import GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.native import NativeStepper
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import make_stepper
from greybox_torch.systems import RobotArm

ARM = RobotArm()
PARAMETERS = tuple(p.name for p in ARM.declared_parameters)
P = np.array([{**ARM.values(), "k_g3": 24.0}[name] for name in PARAMETERS])
X0 = np.array([0.02, -0.01, 15.0, 14.0, 16.0])


def arm_records(lengths: tuple[int, ...] = (120,), hold: str = "zoh", step: float = 5e-4) -> Records:
    """A torque like that of a slow turn with a rich excitation on top, in N m."""
    total = sum(lengths)
    t = step * np.arange(total)
    torque = 2.0 * np.sin(8.0 * t) + sum(np.sin(2 * np.pi * f * t + f) for f in (7.0, 19.0, 31.0, 53.0))
    first = np.concatenate([[0], np.cumsum(lengths)[:-1]])
    last = np.cumsum(lengths) - 1
    return Records(torque[None], np.zeros((1, total)), np.full(total, step), first, last, ("",) * len(lengths), hold)


def native(model: GreyBoxModel = ARM, names: tuple[str, ...] = PARAMETERS, **options: Any) -> NativeStepper:
    stepper = make_stepper(model, names, **options)
    assert isinstance(stepper, NativeStepper)
    return stepper


def arm_with(values: np.ndarray) -> RobotArm:
    arm = RobotArm()
    arm.set_values(dict(zip(PARAMETERS, values, strict=True)))
    return arm


class Oscillator(GreyBoxModel):
    """x'' + 2 d w x' + w² x = u, whose solution under a first-order hold is known in closed form."""

    states = [State("x"), State("v")]
    inputs = [Input("u")]
    outputs = [Output("x")]
    parameters = [Parameter("w", 2.0), Parameter("d", 0.1)]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"x": x.v, "v": u.u - 2 * p.d * p.w * x.v - p.w**2 * x.x}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"x": x.x}
