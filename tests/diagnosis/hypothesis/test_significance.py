"""How sure an improvement is, by windows."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.hypothesis.significance import (
    _nearly_all_removed,
    over_the_same_windows,
    window_significance,
)
from greybox_torch.diagnosis.settings import DiagnosisSettings

SETTINGS = DiagnosisSettings()


@pytest.fixture
def fitted(stub):
    """A hypothesis of which only window energies are known."""

    def make(*energies):
        return stub(fits=tuple(stub(energies=np.asarray(e, dtype=float)) for e in energies))

    return make


def energies(seed: int, count: int = 64, samples: int = 100) -> np.ndarray:
    """Energies of windows of noise."""
    return np.random.default_rng(seed).chisquare(samples, count) / samples


def test_chance_is_not_sure(fitted) -> None:
    """A parameter that is not there takes up one degree of freedom: here it lowers some windows' energies a little, raises others."""
    high = 0
    for seed in range(200):
        before = energies(seed)
        after = before + np.random.default_rng(seed + 1000).normal(0, 0.01, 64)
        high += window_significance(fitted(before), fitted(after), SETTINGS) > 3.0
    assert high <= 4


def test_everywhere_is_sure(fitted) -> None:
    before = energies(0)
    assert window_significance(fitted(before), fitted(0.7 * before), SETTINGS) > 10.0


def test_an_effect_that_varies_by_orders_of_magnitude_is_sure(fitted) -> None:
    before = energies(0) * np.geomspace(1.0, 1e6, 64)
    after = before * np.random.default_rng(1).uniform(0.6, 0.9, 64)
    assert window_significance(fitted(before), fitted(after), SETTINGS) > 5.0


def test_one_window_is_sure(fitted) -> None:
    noise = np.random.default_rng(2).normal(1.0, 0.01, 64)
    before = energies(0)
    after = before * noise
    before[20] += 5.0
    assert window_significance(fitted(before), fitted(after), SETTINGS) > 3.0


UNEVEN = np.array(
    [7.67, 0.01, 0.004, 1.46, 1.29, 0.043, 1.04, 0.038, 6.1, 0.147, 0.001, 1.6, 1.06, 0.249, 0.0002, 0.11]
)


def test_most_of_it_gone_is_sure_however_uneven_the_windows_are(fitted) -> None:
    """Seen: a weight that a fan lifts, 95 % of the error gone, and a mean over windows 2.2 standard errors from zero."""
    after = np.maximum(0.04 * UNEVEN, 0.03)
    assert window_significance(fitted(UNEVEN), fitted(after), SETTINGS) > 4.0
    assert window_significance(fitted(UNEVEN), fitted(0.2 * UNEVEN + 0.03), SETTINGS) < 3.0, "a fifth of it stays"


def test_most_of_one_window_gone_is_not_sure_by_its_share(fitted) -> None:
    before = np.r_[100.0, np.full(15, 1e-3)]
    after = np.r_[1.0, np.full(15, 1.1e-3)]
    assert _nearly_all_removed(before, after) < 1.0


def test_worse_is_not_sure(fitted) -> None:
    before = energies(0)
    assert window_significance(fitted(before), fitted(1.3 * before), SETTINGS) < 0.5


def test_few_windows_say_nothing_and_the_surest_length_counts(fitted) -> None:
    few, many = energies(0, 4), energies(1)
    assert window_significance(fitted(few), fitted(0.1 * few), SETTINGS) == 0.0
    assert window_significance(fitted(many, few), fitted(0.7 * many, few), SETTINGS) == window_significance(
        fitted(many), fitted(0.7 * many), SETTINGS
    )


def test_steps_of_fewer_experiments_have_other_windows(stub) -> None:
    then, now, again = (stub(fits=(stub(energies=np.ones(n)), stub(energies=np.ones(n // 4)))) for n in (64, 128, 128))
    assert over_the_same_windows(now, again) and over_the_same_windows(then, then)
    assert not over_the_same_windows(then, now)
