"""The stepper's accuracy: itself uncompiled, scipy, analytic solutions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from greybox_torch.model import GreyBoxModel, Output, State
from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import SimulationOptions
from greybox_torch.simulation.windows import Windows, whole_records
from tests.simulation.arm import ARM, PARAMETERS, X0, Oscillator, P, arm_records, native


def scipy_states(records: Records, rates: Callable[[np.ndarray, np.ndarray], np.ndarray], x0: np.ndarray) -> np.ndarray:
    """States at the samples of records's first experiment, integrated from sample to sample at tight tolerance."""
    states = [x0]
    for n in range(int(records.last[0])):
        h, u0, u1 = records.dt[n], records.u[:, n], records.u[:, n + (records.hold == "foh")]
        between = lambda t, x, h=h, u0=u0, u1=u1: rates(x, u0 + t / h * (u1 - u0))  # noqa: E731
        states.append(solve_ivp(between, (0.0, h), states[-1], method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1])
    return np.array(states)


def arm_rates(x: np.ndarray, u: np.ndarray) -> np.ndarray:
    """The arm's equations once more, in numpy."""
    v = dict(zip(PARAMETERS, P, strict=True))
    twist, arm_twist, motor, gearbox, arm = x
    friction = v["F_v"] * motor + (v["F_c"] + v["F_cs"] / np.cosh(v["alpha"] * motor)) * np.tanh(v["beta"] * motor)
    gear = v["k_g1"] * twist + v["k_g3"] * twist**3 + v["d_g"] * (motor - gearbox)
    spring = v["k_a"] * arm_twist + v["d_a"] * (gearbox - arm)
    return np.array(
        [
            motor - gearbox,
            gearbox - arm,
            (u[0] - friction - gear) / (v["J"] * v["a_m"]),
            (gear - spring) / (v["J"] * v["a_g"]),
            spring / (v["J"] * (1 - v["a_m"] - v["a_g"])),
        ]
    )


@pytest.mark.parametrize("hold", ["zoh", "foh"])
def test_compiled_and_eager_agree(hold: str) -> None:
    records = arm_records((60, 40, 25), hold)
    windows = Windows(np.array([0, 60, 100, 30]), np.array([59, 99, 124, 59]), 40)
    rng = np.random.default_rng(0)
    p = P * (1 + 0.05 * rng.standard_normal((4, len(P))))
    x0 = X0 + rng.standard_normal((4, 5)) * [0.01, 0.01, 1, 1, 1]
    options = {
        "tangents": True,
        "start_directions": np.broadcast_to(np.eye(5), (4, 5, 5)),
        "tangents0": rng.standard_normal((4, len(P), 5)),
        "keep_states": True,
    }
    one = native().run(records, Pass(windows, p, x0, **options), substeps=2)
    other = EagerStepper.of(ARM, PARAMETERS, "cpu", "double").run(records, Pass(windows, p, x0, **options), substeps=2)
    for part in ("y", "dy", "x_end", "dx_end", "states"):
        expected = getattr(other, part)
        np.testing.assert_allclose(
            getattr(one, part), expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max(), err_msg=part
        )


@pytest.mark.parametrize("hold", ["zoh", "foh"])
def test_against_scipy(hold: str) -> None:
    records = arm_records((80,), hold)
    expected = scipy_states(records, arm_rates, X0)
    run = native(names=()).run(records, Pass(whole_records(records), P, X0[None], keep_states=True), substeps=8)
    assert run.states is not None
    np.testing.assert_allclose(run.states[0], expected, rtol=1e-8, atol=1e-8)
    np.testing.assert_allclose(run.y[0, :, 0], expected[:, 2], rtol=1e-8)


def test_uneven_sample_times() -> None:
    records = arm_records((40,), "foh")
    uneven = Records(
        records.u,
        records.y,
        records.dt * np.random.default_rng(1).uniform(0.3, 1.5, 40),
        *arm_ends(records),
        records.hold,
    )
    run = native(names=()).run(uneven, Pass(whole_records(uneven), P, X0[None], keep_states=True), substeps=8)
    assert run.states is not None
    np.testing.assert_allclose(run.states[0], scipy_states(uneven, arm_rates, X0), rtol=1e-8, atol=1e-8)


def arm_ends(records: Records) -> tuple[np.ndarray, np.ndarray, tuple[str, ...]]:
    return records.first, records.last, records.names


def oscillator_solution(records: Records, x0: np.ndarray) -> np.ndarray:
    """With the input's value and slope as further states, a sample is one matrix exponential."""
    w, d, h = 2.0, 0.1, records.dt[0]
    a = np.array([[0, 1, 0, 0], [-(w**2), -2 * d * w, 1, 0], [0, 0, 0, 1], [0, 0, 0, 0]])
    step, x, positions = expm(a * h), x0, []
    for n in range(len(records.dt)):
        positions.append(x[0])
        following = records.u[0, min(n + 1, len(records.dt) - 1)] if records.hold == "foh" else records.u[0, n]
        x = (step @ np.array([*x, records.u[0, n], (following - records.u[0, n]) / h]))[:2]
    return np.array(positions)


@pytest.mark.parametrize("hold", ["zoh", "foh"])
def test_order_of_convergence(hold: str) -> None:
    records = Records(
        np.sin(np.arange(30.0))[None], np.zeros((1, 30)), np.full(30, 0.4), np.array([0]), np.array([29]), ("",), hold
    )
    x0, p = np.array([1.0, -0.5]), np.array([2.0, 0.1])
    exact = oscillator_solution(records, x0)
    stepper = native(Oscillator(), ())
    errors = [
        np.abs(stepper.run(records, Pass(whole_records(records), p, x0[None]), substeps=m).y[0, :, 0] - exact).max()
        for m in (1, 2, 4, 8, 16)
    ]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(orders[1:], 4.0, atol=0.15)
    assert errors[-1] < 1e-6


@pytest.mark.parametrize("compiled", [True, False])
def test_single_precision(compiled: bool) -> None:
    records = arm_records((60,))
    double = native().run(records, Pass(whole_records(records), P, X0[None], tangents=True))
    single = (
        native(options=SimulationOptions(precision="float"))
        if compiled
        else EagerStepper.of(ARM, PARAMETERS, "cpu", "float")
    )
    run = single.run(records, Pass(whole_records(records), P, X0[None], tangents=True))
    assert double.dy is not None
    assert run.dy is not None
    assert 0 < np.abs(run.y - double.y).max() < 1e-3
    np.testing.assert_allclose(run.dy, double.dy, rtol=1e-2, atol=1e-3 * np.abs(double.dy).max())


def test_a_model_without_inputs_and_parameters() -> None:
    class Decay(GreyBoxModel):
        states = [State("x")]
        outputs = [Output("x")]

        def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
            return {"x": -x.x}

        def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
            return {"x": x.x}

    records = Records(
        np.zeros((0, 20)), np.zeros((1, 20)), np.full(20, 0.1), np.array([0]), np.array([19]), ("",), "zoh"
    )
    for stepper in (native(Decay(), ()), EagerStepper.of(Decay(), (), "cpu", "double")):
        y = stepper.run(records, Pass(whole_records(records), np.zeros(0), np.ones((1, 1))), substeps=4).y
        np.testing.assert_allclose(y[0, :, 0], np.exp(-0.1 * np.arange(20)), rtol=1e-7)


def test_states_that_act_on_nothing() -> None:
    """A position that no output sees is simulated like any other state."""

    class Travelled(Oscillator):
        states = [*Oscillator.states, State("way")]

        def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
            return {**super().derivative(x, u, p, port), "way": x.v}

    records = Records(
        np.sin(np.arange(30.0))[None], np.zeros((1, 30)), np.full(30, 0.1), np.array([0]), np.array([29]), ("",), "zoh"
    )
    p, x0 = np.array([2.0, 0.1]), np.array([[1.0, -0.5, 7.0]])
    run = native(Travelled(), ("w",)).run(records, Pass(whole_records(records), p, x0, tangents=True, keep_states=True))
    other = EagerStepper.of(Travelled(), ("w",), "cpu", "double").run(
        records, Pass(whole_records(records), p, x0, tangents=True, keep_states=True)
    )
    assert run.states is not None
    assert other.states is not None
    np.testing.assert_allclose(run.states, other.states, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(run.states[0, :, 2] - 7.0, run.states[0, :, 0] - 1.0, atol=1e-12)
    assert run.dy is not None
    assert other.dy is not None
    np.testing.assert_allclose(run.dy, other.dy, rtol=1e-12, atol=1e-12)
