"""What a learned curve is compared with."""

from __future__ import annotations

import numpy as np
import pytest

from experiments.concealed.learned_curve import arm_friction, concealed_force
from experiments.concealed.plant_arm import NOMINAL, ArmPlant


def test_force_of_an_effect_by_its_own_law() -> None:
    switches = {"speed_bump.height": 0.5, "speed_bump.center": 14.0, "speed_bump.width": 2.0, "speed_bump.v_0": 0.1}
    key = {"effects": ["speed_bump"], "switches": switches}
    force = concealed_force(key, np.array([-14.0, 0.0, 14.0, 16.0, 40.0]))
    expected = [0.5, 0.0, -0.5, -0.5 * np.exp(-0.5), 0.0]
    assert force == pytest.approx(expected, abs=1e-9)


def test_friction_of_the_arm_as_the_plant_has_it() -> None:
    plant = ArmPlant({name: np.full(5, value) for name, value in NOMINAL.items()})
    state = np.zeros((plant.rows, 5))
    state[2] = [-20.0, -0.3, 0.0, 0.3, 20.0]
    np.testing.assert_allclose(arm_friction(NOMINAL, state[2]), plant.motion(0.0, state, np.zeros(5)).motor_force)
