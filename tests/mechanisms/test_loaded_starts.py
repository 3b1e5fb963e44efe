"""Start states of a model without play, taken over by the model with it."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.transmission import Backlash
from tests.mechanisms.attaching import ARM, ARM_START, attached, records_of

GAP = {"gear_spring.backlash.half_gap": 0.05}


def taken_over(model, known, states, **values):
    named = {p.name: p.value for p in model.declared_parameters} | values
    samples = np.zeros(len(states), dtype=int)
    return model.taken_over(states, known, records_of(20), samples, np.array(list(named.values())))


@pytest.fixture
def with_play(around):
    return attached(ARM, around, attach(ARM, "gear_spring", Backlash(), "+gear_twist"))


@pytest.mark.parametrize("twist", [0.02, -0.03, 0.0])
def test_a_loaded_shaft_begins_at_the_end_of_its_play(with_play, twist) -> None:
    """Then the spring is as far deflected as it was without play. The other states stay."""
    states = np.repeat(ARM_START, 3, axis=0)
    states[:, 0] = twist
    moved = taken_over(with_play, ARM, states, **GAP)
    np.testing.assert_allclose(moved[:, 0], twist + 0.05 * np.sign(twist))
    np.testing.assert_array_equal(moved[:, 1:], states[:, 1:])


def test_the_spring_sees_what_it_saw(with_play, law) -> None:
    states = np.repeat(ARM_START, 2, axis=0)
    states[:, 0] = [0.02, -0.03]
    moved = taken_over(with_play, ARM, states, **GAP)
    seen = law(Backlash(), {"half_gap": 0.05}, deflection=moved[:, 0])
    np.testing.assert_allclose(seen, states[:, 0], atol=1e-12)


def test_where_the_play_is_known_already_or_takes_another_law_s_place_nothing_moves(with_play, around) -> None:
    stiffer = attached(ARM, around, attach(ARM, "gear_spring", LIBRARY["nonlinear_stiffness"]()))
    for known in (with_play, stiffer):
        np.testing.assert_array_equal(taken_over(with_play, known, ARM_START, **GAP), ARM_START)
    np.testing.assert_array_equal(taken_over(stiffer, ARM, ARM_START), ARM_START)


def test_a_refit_begins_with_a_narrower_and_with_a_wider_gap_as_well(around) -> None:
    gap = Backlash().widest(around) / 1.2
    assert [v["half_gap"] for v in Backlash().begun_elsewhere(around, {"half_gap": gap})] == [pytest.approx(0.8 * gap)]
    narrow = [v["half_gap"] for v in Backlash().begun_elsewhere(around, {"half_gap": 0.1 * gap})]
    assert narrow == [pytest.approx(0.08 * gap), pytest.approx(0.125 * gap)]
    assert Backlash().begun_elsewhere(around, {"half_gap": 0.0}) == []
