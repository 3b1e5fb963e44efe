"""A law in the network's place is judged as accurately as it is fitted."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.training import Trained, TrainingSettings, train_hybrid
from greybox_torch.training.explain import Explanation, explain

from .conftest import Turntable

SHORT = TrainingSettings(epochs=8, refresh=3, patience=8, learning_rate=0.03)
STEEP = 0.02
"""Speed over which the friction changes its sign, rad/s: one Runge-Kutta step a sample is too long for it."""


@pytest.fixture(scope="module")
def of_a_steep_law(data_set) -> Trained:
    rng = np.random.default_rng(0)
    experiments = []
    for samples in (1200, 800, 600):
        torque, speeds, w = np.repeat(rng.uniform(-0.45, 0.45, samples // 20), 20), [], 0.5
        for u in torque:
            speeds.append(w)
            for _ in range(100):
                w += 1e-4 * (u - 0.05 * w - 0.1 * np.tanh(w / STEEP)) / 0.02
        experiments.append({"torque": torque, "speed": np.array(speeds) + rng.normal(0.0, 1e-3, samples)})
    roles = ["estimation", "estimation", "validation"]
    data = data_set({"torque": "N m", "speed": "rad/s"}, experiments, roles=roles)
    return train_hybrid(data, Turntable(), settings=SHORT, network={"units": 5})


@pytest.fixture(scope="module")
def explained(of_a_steep_law: Trained) -> Explanation:
    return explain(of_a_steep_law)


def test_a_steep_law_replaces_a_network_that_was_trained_with_few_steps(
    explained: Explanation, of_a_steep_law: Trained
) -> None:
    assert explained.term is not None and explained.sentence.endswith("Drop the network.")
    (coulomb,) = [t for t in explained.terms if t.attachment.mechanism.name == "coulomb_friction"]
    assert coulomb.simulator.substeps > of_a_steep_law.course.simulator.substeps
    assert coulomb.parameters["F_c"] == pytest.approx(0.1, rel=0.02)
    assert coulomb.held_out == pytest.approx(1e-3**2, rel=0.3)


def test_the_network_is_taken_at_its_best(explained: Explanation, of_a_steep_law: Trained) -> None:
    chosen = of_a_steep_law.polished.chosen.held_out
    assert all(t.lost >= t.held_out / chosen - 1.0 for t in explained.terms)
