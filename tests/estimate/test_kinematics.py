"""Start values of speeds that no sensor shows, from the slope of the positions that one does."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.estimate.kinematics import hidden_starts, kinematics_of
from greybox_torch.mechanisms.actuator import InputDelay
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.simulation.records import Records

STEP = 0.01


class Cart(GreyBoxModel):
    """Position measured, speed not."""

    states = [State("x", "m", initial="measured"), State("v", "m/s")]
    inputs = [Input("F", "N")]
    outputs = [Output("x", "m")]
    parameters = [Parameter("m", 2.0, unit="kg", lower=0.1)]
    ports = [Body("cart", speed="v", position="x")]

    def derivative(self, x, u, p, port):
        return {"x": x.v, "v": (u.F + port.cart) / p.m}

    def output(self, x, u, p):
        return {"x": x.x}


class Strut(Cart):
    """The travel between two speeds, of which one is measured; the other follows."""

    states = [State("x", "m"), State("upper", "m/s"), State("lower", "m/s")]
    outputs = [Output("x", "m"), Output("upper", "m/s")]
    ports = [Body("top", speed="upper")]

    def derivative(self, x, u, p, port):
        return {"x": x.upper - x.lower, "upper": (u.F + port.top) / p.m, "lower": -x.lower}

    def output(self, x, u, p):
        return {"x": x.x, "upper": x.upper}


class Scaled(Cart):
    """The rate depends on a parameter, which may be wrong: nothing follows from it."""

    def derivative(self, x, u, p, port):
        return {"x": p.m * x.v, "v": (u.F + port.cart) / p.m}


def records(*outputs: np.ndarray) -> Records:
    n = len(outputs[0])
    return Records(
        u=np.zeros((1, n)),
        y=np.array(outputs),
        dt=np.full(n, STEP),
        first=np.array([0]),
        last=np.array([n - 1]),
        names=("run",),
        hold="zoh",
    )


def test_a_speed_is_the_slope_of_its_position() -> None:
    time = STEP * np.arange(200)
    samples = np.array([0, 40, 199])
    states = np.zeros((3, 2))
    found = hidden_starts(Cart(), records(np.sin(3 * time)), states, samples, 40)
    np.testing.assert_allclose(found[:, 1], 3 * np.cos(3 * time[samples]), atol=0.02)
    assert not states.any()


def test_a_straight_line_has_its_slope_exactly_though_samples_are_missing() -> None:
    line = 0.7 * STEP * np.arange(100)
    line[[50, 52]] = np.nan
    found = hidden_starts(Cart(), records(line), np.zeros((2, 2)), np.array([0, 51]), 40)
    np.testing.assert_allclose(found[:, 1], 0.7, rtol=1e-9)


def test_what_is_missing_altogether_stays_as_it_was() -> None:
    found = hidden_starts(Cart(), records(np.full(100, np.nan)), np.full((1, 2), 0.3), np.array([50]), 40)
    np.testing.assert_array_equal(found, [[0.3, 0.3]])


def test_the_other_end_of_a_strut_follows_from_both_measurements() -> None:
    time = STEP * np.arange(200)
    upper = np.cos(time)
    states = np.column_stack([np.zeros(1), upper[[60]], np.zeros(1)])
    found = hidden_starts(Strut(), records(0.4 * time, upper), states, np.array([60]), 40)
    np.testing.assert_allclose(found[:, 2], upper[60] - 0.4, atol=1e-6)


@pytest.mark.parametrize("model", [Scaled])
def test_a_rate_that_depends_on_a_parameter_says_nothing(model) -> None:
    assert kinematics_of(model()) is None


def test_inputs_that_an_effect_adds_are_no_part_of_it() -> None:
    cart = Cart()
    around = {"actuator": Surroundings({"input": Range(-1.0, 1.0, 0.5)}, {"input": "N"}, "N", STEP)}
    delayed = AugmentedModel(cart, [attach(cart, "actuator", InputDelay())], around)
    found = hidden_starts(delayed, records(0.3 * STEP * np.arange(100)), np.zeros((1, 2)), np.array([50]), 40)
    np.testing.assert_allclose(found[:, 1], 0.3, rtol=1e-9)
