"""The smoother against dense algebra, and against a force that is known."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from experiments.concealed.against.plain import Plain
from experiments.concealed.against.residual_force import Smoother, solved

DRAG = 0.02
"""N m s^2/rad^2, as in the fixture."""


@given(st.integers(0, 1000), st.integers(2, 6), st.integers(1, 4))
def test_the_block_tridiagonal_solution_is_that_of_dense_algebra(seed: int, count: int, size: int) -> None:
    rng = np.random.default_rng(seed)
    dense = np.zeros((count * size, count * size))
    below = rng.standard_normal((count - 1, size, size))
    for k in range(count):
        part = rng.standard_normal((size, size))
        dense[k * size :][:size, k * size :][:, :size] = part @ part.T + 10.0 * np.eye(size) * size
    for k in range(count - 1):
        dense[(k + 1) * size : (k + 2) * size, k * size : (k + 1) * size] = below[k]
        dense[k * size : (k + 1) * size, (k + 1) * size : (k + 2) * size] = below[k].T
    diagonal = np.stack([dense[k * size :][:size, k * size :][:, :size] for k in range(count)])
    right = rng.standard_normal((count, size))
    expected = np.linalg.solve(dense, right.ravel()).reshape(count, size)
    np.testing.assert_allclose(solved(diagonal, below, right), expected, rtol=1e-7, atol=1e-9)


def test_the_missing_force_is_the_drag_and_what_the_tuned_friction_has_taken_of_it(
    tuned: Callable[[str], Plain],
) -> None:
    plain = tuned("drag")
    smoother = Smoother(plain, "rotor")
    found = smoother.run(smoother.start(), 300.0)
    speed, torque = found.states[:, 0], 0.1 * plain.problem.records.u[0]
    values = dict(zip(plain.problem.names, plain.problem.values, strict=True))
    true_acceleration = (torque - 0.03 * speed - DRAG * speed * abs(speed)) / 0.02
    expected = values["J"] * true_acceleration - (torque - values["b"] * speed)
    assert np.sqrt(np.mean((found.force - expected) ** 2)) < 0.25 * np.sqrt(np.mean(expected**2))
    assert np.corrcoef(found.force, expected)[0, 1] > 0.97


def test_a_model_that_lacks_nothing_is_given_no_force_to_speak_of(tuned: Callable[[str], Plain]) -> None:
    smoother = Smoother(tuned("plain"), "rotor")
    force = smoother.run(smoother.start(), 1000.0).force
    assert np.sqrt(np.mean(force**2)) < 0.02 * 0.1 * np.sqrt(np.mean(smoother.records.u[0] ** 2))
