"""Two laws from one learned curve; the curves are made by NumPy."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from greybox_torch.mechanisms.matching_pairs import matching_pair

SPEED = torch.linspace(-20.0, 16.0, 400, dtype=torch.float64)
V = SPEED.numpy()
WEIGHT = np.exp(-0.5 * (V / 28.8) ** 2)


def dry(force: float, v_0: float = 0.144) -> np.ndarray:
    return -force * np.tanh(V / v_0)


def uneven(delta: float, v_0: float = 0.144) -> np.ndarray:
    return -delta * np.tanh(V / v_0) ** 2


@pytest.mark.parametrize(
    ("force", "laws"),
    [
        (dry(1.75) + uneven(0.85), {"coulomb_friction": {"F_c": 1.75}, "coulomb_asymmetry": {"delta": 0.85}}),
        (dry(1.75) + uneven(0.85) + 0.3 * V, {"coulomb_friction": {"F_c": 1.75}, "coulomb_asymmetry": {"delta": 0.85}}),
        (dry(1.0) - 0.02 * V * np.abs(V), {"coulomb_friction": {"F_c": 1.0}, "quadratic_drag": {"c": 0.02}}),
    ],
)
def test_the_two_that_drew_it_are_found(around, force, laws) -> None:
    """Whatever straight line the model's own damping has taken over."""
    found = matching_pair("body", around, {"speed": SPEED}, force, WEIGHT)
    assert found is not None and found.share > 0.97
    told = {law.name: values for law, values in zip(found.laws, found.values, strict=True)}
    assert set(told) == set(laws)
    for name, sizes in laws.items():
        for parameter, size in sizes.items():
            assert told[name][parameter] == pytest.approx(size, rel=0.15)


@pytest.mark.parametrize(
    "force",
    [
        dry(1.75),  # one law does as well
        0.4 * V,  # the model's own damping
        np.zeros_like(V),
        np.sin(3.0 * V),  # no two laws come near it
        -dry(1.75) - uneven(0.85),  # friction that drives is none
    ],
)
def test_none_where_one_is_enough_or_no_two_come_near(around, force) -> None:
    assert matching_pair("body", around, {"speed": SPEED}, force, WEIGHT) is None


def test_a_straight_line_is_one_of_the_two_where_it_is_not_left_open(around) -> None:
    """Seen: an input's offset and a gain of 1.7 % less, told as unknown at the actuator."""
    u = torch.linspace(-12.0, 9.0, 400, dtype=torch.float64)
    force = -0.017 * u.numpy() - 0.027
    assert matching_pair("actuator", around, {"input": u}, force, np.ones(400)) is None
    found = matching_pair("actuator", around, {"input": u}, force, np.ones(400), line_open=False)
    assert found is not None and found.share > 0.99
    told = {law.name: values for law, values in zip(found.laws, found.values, strict=True)}
    assert told == {"input_gain": {"gain_error": pytest.approx(-0.017)}, "input_bias": {"bias": pytest.approx(-0.027)}}


def test_the_order_of_a_ripple_beside_a_bias_is_the_curves(around) -> None:
    """Seen: a pendulum's bias and ripple of order 7.3, told as unknown since pairs had ripples of the usual orders alone."""
    position = torch.linspace(-3.0, 5.0, 400, dtype=torch.float64)
    force = 0.4 + 0.3 * np.cos(7.3 * position.numpy()) - 0.2 * np.sin(7.3 * position.numpy())
    found = matching_pair("body", around, {"position": position}, force, np.ones(400))
    assert found is not None and found.share > 0.97
    told = {law.name: values for law, values in zip(found.laws, found.values, strict=True)}
    assert set(told) == {"constant_bias", "torque_ripple"}
    assert told["torque_ripple"]["order"] == pytest.approx(7.3, rel=0.02)
    assert told["constant_bias"]["bias"] == pytest.approx(0.4, rel=0.05)


def test_a_law_that_is_there_already_is_no_part_of_it(around) -> None:
    force = dry(1.75) + uneven(0.85)
    found = matching_pair("body", around, {"speed": SPEED}, force, WEIGHT, but={"coulomb_asymmetry"})
    assert found is None or "coulomb_asymmetry" not in {law.name for law in found.laws}


def test_the_first_is_the_one_that_matches_more_by_itself(around) -> None:
    for level, difference, first in ((1.75, 0.8, "coulomb_friction"), (1.0, 1.4, "coulomb_asymmetry")):
        found = matching_pair("body", around, {"speed": SPEED}, dry(level) + uneven(difference), WEIGHT)
        assert found is not None and found.laws[0].name == first
