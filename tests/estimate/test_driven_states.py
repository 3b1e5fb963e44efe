"""States that inputs alone drive stand in for sensors."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import greybox_torch as gt
from greybox_torch.estimate.driven_states import driven_states, simulated_driven
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.reconstruction import Motion, reconstructed
from greybox_torch.estimate.simulators import simulator_for


class Fan(gt.GreyBoxModel):
    """A mass that a fan with two lags in a row pushes; a state that nothing drives beside them."""

    states = [
        gt.State("q", "m", initial="measured"),
        gt.State("w", "m/s"),
        gt.State("thrust", "N", initial=0.0, fixed=True),
        gt.State("air", "N", initial=0.0, fixed=True),
        gt.State("drift", "", initial=0.0, fixed=True),
    ]
    inputs = [gt.Input("voltage", "V")]
    outputs = [gt.Output("q", "m")]
    parameters = [gt.Parameter("m", 0.5, "kg"), gt.Parameter("T", 0.1, "s"), gt.Parameter("d", 0.2, "N s/m")]
    ports = [gt.Body("mass", position="q", speed="w")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {
            "q": x.w,
            "w": (x.thrust - p.d * x.w + port.mass) / p.m,
            "thrust": (x.air - x.thrust) / p.T,
            "air": (u.voltage**2 - x.air) / p.T,
            "drift": -x.drift,
        }

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"q": x.q}


@pytest.fixture(scope="module")
def problem(data_set):
    """Ten seconds of the fan's mass under steps of voltage, simulated by SciPy."""
    rng, dt, n = np.random.default_rng(0), 0.01, 1000
    voltage = np.repeat(rng.uniform(-2, 2, n // 50), 50)
    x, rows = np.zeros(4), []
    for v in voltage:
        rows.append(x)
        rates = lambda t, x, v=v: [x[1], (x[2] - 0.2 * x[1]) / 0.5, (x[3] - x[2]) / 0.1, (v**2 - x[3]) / 0.1]  # noqa: E731
        x = solve_ivp(rates, (0, dt), x, rtol=1e-9, atol=1e-12).y[:, -1]
    true = np.array(rows).T
    measured = true[0] + 1e-5 * rng.standard_normal(n)
    data = data_set(
        {"voltage": "V", "q": "m"}, [{"voltage": voltage, "q": measured}], roles=["estimation"], sample_time=dt
    )
    return make_problem(data, Fan(), data.estimation()), true


def test_a_chain_of_lags_is_driven_and_what_pushes_back_or_is_left_alone_is_not() -> None:
    assert driven_states(Fan()) == (2, 3)


def test_they_are_as_simulated_elsewhere(problem) -> None:
    problem, true = problem
    found = simulated_driven(problem, simulator_for(problem))
    assert set(found) == {2, 3}
    for index, row in found.items():
        np.testing.assert_allclose(row, true[index], atol=2e-4 * np.abs(true[index]).max())


def test_with_them_the_motion_is_shown(problem) -> None:
    """Seen: a pendulum with a fan, whose weight was missing: no output shows the thrust, and so the motion said nothing of the weight."""
    problem, true = problem
    assert reconstructed(problem) == "no output shows thrust, air, drift, or a rate that it follows from"
    driven = {**simulated_driven(problem, simulator_for(problem)), 4: np.zeros(true.shape[1])}
    motion = reconstructed(problem, driven)
    assert isinstance(motion, Motion) and motion.shown.all()
    thrust = np.interp(motion.time, 0.01 * np.arange(true.shape[1]), true[2])
    assert np.abs(motion.states[2] - thrust).max() < 0.02 * np.abs(thrust).max()
    force = 0.5 * motion.rates[1] - motion.states[2] + 0.2 * motion.states[1]
    assert np.sqrt(np.mean(force**2)) < 0.1 * np.sqrt(np.mean(thrust**2))
