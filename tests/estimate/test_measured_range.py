"""How far a signal goes by its sensors: farther than a model without play says, less far than one without a stop, noise aside."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from greybox_torch.estimate.measured_range import farther, no_farther
from greybox_torch.mechanisms.surroundings import Range

SIMULATED = Range(-0.006, 0.004, 0.002)


@given(seed=st.integers(0, 10**6), noise=st.floats(0.0, 0.004))
def test_noise_alone_moves_nothing(seed: int, noise: float) -> None:
    measured = noise * np.random.default_rng(seed).standard_normal(4000)
    found = farther(SIMULATED, measured)
    assert found.low >= SIMULATED.low - 1e-12 and found.high <= SIMULATED.high + 0.1 * noise
    assert found.rms == SIMULATED.rms


@given(seed=st.integers(0, 10**6), noise=st.floats(0.0, 2e-4), missing=st.booleans())
def test_play_that_the_model_lacks_is_taken_in(seed: int, noise: float, missing: bool) -> None:
    rng, time = np.random.default_rng(seed), np.arange(4000)
    measured = 0.002 + 0.015 * np.sin(time / 150.0) + noise * rng.standard_normal(4000)
    if missing:
        measured[100:400] = np.nan
    found = farther(SIMULATED, measured)
    assert -0.0132 < found.low < -0.0122 and 0.0162 < found.high < 0.0172


def test_few_samples_say_nothing() -> None:
    assert farther(SIMULATED, np.array([1.0, np.nan, -1.0])) == SIMULATED


@given(seed=st.integers(0, 10**6), noise=st.floats(0.0, 2e-4))
def test_what_a_model_without_a_stop_runs_past_is_left_out(seed: int, noise: float) -> None:
    rng, time = np.random.default_rng(seed), np.arange(4000)
    measured = np.minimum(np.sin(time / 150.0), 0.2) + noise * rng.standard_normal(4000)
    found = no_farther(Range(-1.0, 0.9, 0.7), measured)
    assert abs(found.low + 1.0) < 1e-3 and abs(found.high - 0.2) < 1e-3
    assert found.rms == np.sqrt(np.mean(measured**2))
    assert no_farther(SIMULATED, np.full(4000, 1.0)) == SIMULATED, "what never moves has no range"
