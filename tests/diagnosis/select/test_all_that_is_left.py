"""How sure a name is, by what all findings together leave."""

from __future__ import annotations

import numpy as np

from greybox_torch.diagnosis.select.posterior import for_all_that_is_left
from greybox_torch.diagnosis.settings import DiagnosisSettings

SETTINGS, SAMPLES = DiagnosisSettings(), 20_000


def test_a_name_is_less_sure_the_more_is_left_with_it(stub) -> None:
    """Seen: dry friction at the wrong port, 0.85, which left 82 times the noise and four fifths of the mismatch."""
    y = 0.1 * np.random.default_rng(5).normal(size=(1, SAMPLES))
    records = stub(y=y, u=y, first=np.array([0]), span=lambda e: slice(0, SAMPLES))
    problem = stub(records=records, weights=np.ones(1))
    much, little = (stub(fits=(stub(mean_square=error),), problem=problem) for error in (1.0, 0.011))
    assert [for_all_that_is_left(0.97, share, much, SETTINGS) for share in (0.01, 0.3, 0.8)] == [0.97, 0.85, 0.5]
    assert for_all_that_is_left(0.3, 0.8, much, SETTINGS) == 0.3
    assert for_all_that_is_left(0.97, 0.8, little, SETTINGS) == 0.97, "near the noise"
    free_runs = [for_all_that_is_left(0.97, 0.01, much, SETTINGS, of_free_runs=left) for left in (0.5, 0.9)]
    assert free_runs == [0.97, 0.97], "over windows next to nothing is left"
    assert for_all_that_is_left(0.97, 0.3, much, SETTINGS, of_free_runs=0.9) == 0.5
    assert for_all_that_is_left(0.97, 0.3, little, SETTINGS, of_free_runs=0.9) == 0.97
