"""Evidence, probabilities and deviations, against closed forms and simulated experiments."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.experiment_design.separation import (
    deviation,
    evidence,
    expected_probability,
    scaled_inverse,
    seconds_for,
)

SLOPES = np.random.default_rng(0).normal(size=(200, 3))
NOTHING = np.zeros((3, 3))


@pytest.fixture
def rng() -> np.random.Generator:
    """The same draws for every test, whatever ran before in its process."""
    return np.random.default_rng(1)


def test_half_the_squared_difference_where_the_rival_has_nothing_to_adjust(rng: np.random.Generator) -> None:
    difference = rng.normal(size=200)
    assert evidence(difference, np.zeros((200, 1)), np.zeros((1, 1))) == pytest.approx(0.5 * difference @ difference)


def test_what_the_rival_can_imitate_is_no_evidence() -> None:
    assert evidence(SLOPES @ [1.0, -2.0, 0.5], SLOPES, NOTHING) == pytest.approx(0.0, abs=1e-9)


def test_what_is_known_keeps_the_rival_from_imitating() -> None:
    difference = SLOPES @ [1.0, -2.0, 0.5]
    known = [evidence(difference, SLOPES, size * np.eye(3)) for size in (1e-3, 1.0, 1e3, 1e9)]
    assert known == sorted(known) and known[-1] == pytest.approx(0.5 * difference @ difference, rel=1e-6)


def test_evidence_is_the_minimum_over_the_rivals_unknowns(rng: np.random.Generator) -> None:
    difference, known = rng.normal(size=200), np.diag([1.0, 20.0, 300.0])
    found = evidence(difference, SLOPES, known)

    def at(step: np.ndarray) -> float:
        left = difference - SLOPES @ step
        return float(0.5 * left @ left + 0.5 * step @ known @ step)

    best = np.linalg.solve(SLOPES.T @ SLOPES + known, SLOPES.T @ difference)
    assert found == pytest.approx(at(best))
    assert all(at(best + 0.01 * rng.normal(size=3)) >= found for _ in range(20))


def test_units_do_not_matter(rng: np.random.Generator) -> None:
    difference, scale = rng.normal(size=200), np.array([1e-9, 1.0, 1e9])
    known = np.diag([1.0, 20.0, 300.0])
    other = evidence(difference, SLOPES * scale, known * np.outer(scale, scale))
    assert other == pytest.approx(evidence(difference, SLOPES, known), rel=1e-6)


def test_probability_after_simulated_experiments(rng: np.random.Generator) -> None:
    """Two hypotheses with known outputs in white noise: Bayes's rule over many noises comes to the expectation."""
    difference, before = 0.15 * rng.normal(size=200), (0.7, 0.3)
    nats = 0.5 * float(difference @ difference)
    right = []
    for own, sign in zip(before, (1.0, -1.0), strict=True):
        told = sign * nats + rng.normal(size=(4000, 200)) @ difference  # log-likelihood of the first against the second
        first = before[0] / (before[0] + before[1] * np.exp(-told))
        right.append(own * np.mean(first if sign > 0 else 1 - first))
    expected = expected_probability(before, np.array([[0.0, nats], [nats, 0.0]]))
    assert expected == pytest.approx(sum(right), abs=0.01)


def test_no_evidence_leaves_probabilities_and_much_decides() -> None:
    before = (0.5, 0.3, 0.2)
    assert expected_probability(before, np.zeros((3, 3))) == pytest.approx(sum(p**2 for p in before), abs=1e-6)
    assert expected_probability(before, 1e4 * (1 - np.eye(3))) == pytest.approx(1.0)


def test_seconds_that_are_needed() -> None:
    before, nats = (0.5, 0.5), np.array([[0.0, 1.0], [1.0, 0.0]])
    needed = seconds_for(before, nats, 2.0, 0.95)
    assert expected_probability(before, nats * needed / 2.0) == pytest.approx(0.95, abs=1e-6)
    assert seconds_for(before, np.zeros((2, 2)), 2.0, 0.95) == np.inf


def test_deviation_is_that_of_least_squares() -> None:
    covariance = np.linalg.inv(SLOPES.T @ SLOPES + np.eye(3))
    for k in range(3):
        assert deviation(SLOPES, np.eye(3), k) == pytest.approx(np.sqrt(covariance[k, k]))
    assert deviation(np.zeros((200, 3)), NOTHING, 1) == np.inf


def test_an_inverse_of_parameters_in_very_different_units() -> None:
    scale = np.diag([1e-12, 1.0, 1e12])
    matrix = scale @ (SLOPES.T @ SLOPES) @ scale
    expected = np.linalg.inv(SLOPES.T @ SLOPES)
    np.testing.assert_allclose(scale @ scaled_inverse(matrix) @ scale, expected, rtol=1e-6)
