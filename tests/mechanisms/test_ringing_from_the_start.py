"""Recordings that begin while a mode, or whatever else remembers, still rings."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.window_fit import WindowFit, fit_windows
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.forces import AdditionalMode
from greybox_torch.mechanisms.mechanism import Mechanism, Surroundings
from greybox_torch.mechanisms.surroundings import Range
from greybox_torch.mechanisms.unknown_with_memory import UnknownWithMemory
from greybox_torch.simulation.simulator import Simulator

MASS, OMEGA, ZETA, STEP = 0.3, 40.0, 0.1, 0.002
UNITS = {"push": "N", "speed": "m/s"}


class Cart(gt.GreyBoxModel):
    """A mass of 1 kg with a damper."""

    states = [gt.State("speed", "m/s", initial="measured")]
    inputs = [gt.Input("push", "N")]
    outputs = [gt.Output("speed", "m/s")]
    ports = [gt.Body("cart", speed="speed")]
    parameters = [gt.Parameter("d", 0.5, unit="N s/m", lower=0.0)]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": u.push - p.d * x.speed + port.cart}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": x.speed}


def recorded(data_set: Any) -> gt.DataSet:
    """The cart with a mass on a spring, by the eigenvalues of the three equations: it begins with the spring stretched."""
    spring, damper = MASS * OMEGA**2, 2.0 * ZETA * OMEGA * MASS
    rates = np.array(
        [[-0.5 - damper, spring, damper], [-1.0, 0.0, 1.0], [damper / MASS, -spring / MASS, -damper / MASS]]
    )
    push = np.repeat(np.random.default_rng(0).uniform(-1.0, 1.0, 40), 50)
    values, vectors = np.linalg.eig(rates)
    held = (vectors * np.exp(values * STEP)) @ np.linalg.inv(vectors)
    gained = np.linalg.solve(rates, (held - np.eye(3)) @ np.array([1.0, 0.0, 0.0]))
    states = [np.array([0.1, 0.02, -0.3])]
    for u in push[:-1]:
        states.append((held @ states[-1] + gained * u).real)
    return data_set(UNITS, [{"push": push, "speed": np.array(states)[:, 0]}], sample_time=STEP)


def windows(data: gt.DataSet, mechanism: Mechanism, around: Any, **begun: float) -> tuple[WindowFit, float]:
    """The fit over the longest of three lengths of windows, each begun with the one before, and its root mean square error in m/s."""
    model = Cart()
    augmented = AugmentedModel(model, [attach(model, "cart", mechanism)], around)
    values = {f"cart.{mechanism.name}.{name}": value for name, value in begun.items()}
    problem = make_problem(data, augmented, data.estimation(), values=values)
    simulator, fit = Simulator.of(augmented, problem.free_names), None
    for length in (50, 200, 1000):
        fit = fit_windows(problem if fit is None else fit.problem, simulator, length, shorter=fit)
        assert fit is not None
    return fit, float(np.sqrt(fit.mean_square) / problem.weights[0])


def test_a_mode_that_rings_where_a_record_begins_is_followed_from_there(data_set: Any) -> None:
    """Seen: a pendulum's mode, told as an unknown effect at its drive (0.97), as what it began with was left over every length."""
    around = {"cart": Surroundings({"speed": Range(-1.0, 1.0, 0.4)}, {"speed": "m/s"}, "N", STEP)}
    fit, error = windows(recorded(data_set), AdditionalMode(), around, mass=0.28, omega=38.0, zeta=0.06)
    found = fit.problem.values_by_name
    assert found["cart.additional_mode.mass"] == pytest.approx(MASS, rel=1e-3)
    assert found["cart.additional_mode.omega"] == pytest.approx(OMEGA, rel=1e-3)
    assert found["cart.additional_mode.zeta"] == pytest.approx(ZETA, rel=1e-2)
    assert error < 1e-4  # 0.025 with a mode that begins at rest, and a frequency of 50 rad/s
    assert fit.problem.initial[0] == pytest.approx([0.1, 0.02, -0.3], rel=1e-2)


@pytest.mark.parametrize("modes", [1, 2])
def test_what_an_unknown_remembers_begins_anywhere_too(modes: int) -> None:
    mechanism = UnknownWithMemory("speed", modes=modes)
    assert mechanism.lasting == ("z", "r")[:modes]
