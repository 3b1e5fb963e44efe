"""Sensitivities that have grown out of all proportion are no knowledge of a parameter."""

from __future__ import annotations

import numpy as np

from greybox_torch.experiment_design.separation import deviation
from greybox_torch.experiment_design.trusted import trusted

TIME = np.linspace(0.0, 10.0, 1000)
SIZES = np.ones(1)


def test_slopes_that_grow_with_the_time_are_taken_as_they_are() -> None:
    slopes = np.stack([np.sin(TIME), TIME * np.cos(TIME)], axis=1)[:, None, :]
    assert trusted(slopes, np.array([1.0, 1.0]), SIZES) is slopes


def test_what_all_but_slips_says_nothing_from_there_on() -> None:
    """Seen: "bring the standard deviation of m_p from inf to 6.1e-11 kg", where the report has ± 0.0014."""
    sound = np.stack([np.sin(TIME), np.cos(3 * TIME)], axis=1)[:, None, :]
    grown = sound + np.where(TIME > 8.0, 1e-3 * np.exp(15.0 * np.clip(TIME - 8.0, 0, None)), 0.0)[:, None, None]
    kept = trusted(grown, np.array([1.0, 1.0]), SIZES)
    cut = int(np.flatnonzero(~kept.any(axis=(1, 2)))[0])
    assert 8.0 < TIME[cut] < 9.5 and np.array_equal(kept[:cut], grown[:cut]) and not kept[cut:].any()
    told = deviation(kept[:, 0], np.zeros((2, 2)), 0)
    assert 0.1 < told / deviation(sound[:, 0], np.zeros((2, 2)), 0) < 10.0
