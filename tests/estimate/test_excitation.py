"""Up to which frequency inputs move a machine."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.estimate.excitation import any_input_moves, excited_band, excited_up_to
from greybox_torch.simulation.records import Records

STEP, SAMPLES = 0.01, 3000
TIME = STEP * np.arange(SAMPLES)


def sine(frequency: float, size: float = 1.0) -> np.ndarray:
    return size * np.sin(2 * np.pi * frequency * TIME)


def recorded(*inputs: np.ndarray) -> Records:
    """Two experiments of half the samples each."""
    half = SAMPLES // 2
    first, last = np.array([0, half]), np.array([half - 1, SAMPLES - 1])
    return Records(np.array(inputs), np.zeros((1, SAMPLES)), np.full(SAMPLES, STEP), first, last, ("a", "b"), "zoh")


def test_excited_band_of_a_sum_of_sines() -> None:
    both = 5.0 + sine(2.0)
    assert excited_band(both + sine(30.0, 0.05), STEP, 0.99) == pytest.approx(2.0)
    assert excited_band(both + sine(30.0, 0.2), STEP, 0.99) == pytest.approx(30.0)
    assert excited_band(np.full(100, 3.0), STEP, 0.99) == 0.0


def test_the_input_and_the_experiment_that_reach_highest_count() -> None:
    in_one = sine(2.0) + np.where(TIME < STEP * SAMPLES / 2, sine(12.0), 0.0)
    assert excited_up_to(recorded(sine(2.0))) == pytest.approx(2 * np.pi * 2.0)
    assert excited_up_to(recorded(in_one)) == pytest.approx(2 * np.pi * 12.0)
    assert excited_up_to(recorded(sine(2.0), sine(20.0))) == pytest.approx(2 * np.pi * 20.0)


def test_an_input_moves_within_an_experiment_or_not_at_all() -> None:
    assert any_input_moves(recorded(sine(2.0))) and any_input_moves(recorded(np.full(SAMPLES, 3.0), sine(2.0)))
    assert not any_input_moves(recorded(np.full(SAMPLES, 3.0), np.full(SAMPLES, -1.0)))


def test_where_no_input_moves_nothing_is_known() -> None:
    constant = recorded(np.full(SAMPLES, 3.0))
    assert excited_up_to(constant) == float("inf")
    assert excited_up_to(replace(constant, u=np.zeros((0, SAMPLES)))) == float("inf")
