"""States set anew along a record while others go on: as if every stretch were a pass of its own."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greybox_torch.model import GreyBoxModel, Input, Output, State
from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.passes import Pass, Restarts
from greybox_torch.simulation.stepper import Stepper
from greybox_torch.simulation.windows import Windows, whole_records
from tests.simulation.arm import ARM, X0, P, arm_records, native

EVERY = 30
KEPT = np.array([True, False, False, False, True])


@pytest.fixture(params=["compiled", "eager"])
def stepper(request: pytest.FixtureRequest) -> Stepper:
    return native(names=()) if request.param == "compiled" else EagerStepper.of(ARM, (), "cpu", "double")


def restarts(experiments: int, count: int) -> Restarts:
    starts = X0 + np.random.default_rng(3).standard_normal((experiments, count, 5)) * [0.01, 0.01, 1.0, 1.0, 1.0]
    return Restarts(EVERY, KEPT, starts)


def test_the_kept_states_go_on_and_the_others_begin_anew(stepper: Stepper) -> None:
    """Two experiments, the second with fewer stretches; each stretch once more as a pass of its own from where the one before ended."""
    records, asked = arm_records((120, 95)), restarts(2, 4)
    begun = stepper.run(records, Pass(whole_records(records), P, asked.starts[:, 0], restarts=asked)).begun
    assert begun is not None
    for e, stretches in ((0, 4), (1, 3)):
        state = asked.starts[e, 0]
        np.testing.assert_array_equal(begun[e, 0], state)
        for k in range(1, stretches):
            first = int(records.first[e]) + (k - 1) * EVERY
            stretch = Windows(np.array([first]), np.array([first + EVERY]), EVERY + 1)
            run = stepper.run(records, Pass(stretch, P, state[None], keep_states=True))
            assert run.states is not None
            state = np.where(KEPT, run.states[0, EVERY], asked.starts[e, k])
            np.testing.assert_allclose(begun[e, k], state, rtol=1e-12, atol=1e-14)


def test_a_kept_state_that_is_lost_goes_on_from_zero(stepper: Stepper) -> None:
    records, asked = arm_records((90,)), restarts(1, 3)
    asked.starts[0, 0] = np.nan
    begun = stepper.run(records, Pass(whole_records(records), P, asked.starts[:, 0], restarts=asked)).begun
    assert begun is not None
    np.testing.assert_array_equal(begun[0, 1], np.where(KEPT, 0.0, asked.starts[0, 1]))
    assert np.isfinite(begun[0, 2]).all()


class Runaway(GreyBoxModel):
    """x' = x², which leaves all numbers behind."""

    states = [State("x", "rad")]
    inputs = [Input("u", "rad/s")]
    outputs = [Output("x", "rad")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"x": x.x * x.x + u.u}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"x": x.x}


def test_a_kept_state_beyond_all_numbers_stays_there() -> None:
    """Seen: torch operations went on from 1.8e308, compiled code from infinity."""
    records, starts = arm_records((90,)), np.full((1, 3, 1), 1e200)
    asked = Restarts(EVERY, np.array([True]), starts)
    for stepper in (native(Runaway(), names=()), EagerStepper.of(Runaway(), (), "cpu", "double")):
        begun = stepper.run(records, Pass(whole_records(records), np.zeros(0), starts[:, 0], restarts=asked)).begun
        assert begun is not None
        assert begun[0, :, 0].tolist() == [1e200, np.inf, np.inf]
