"""Long windows that begin from what shorter ones found."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from greybox_torch.diagnosis.hypothesis import states_first as module
from greybox_torch.diagnosis.hypothesis.fit import window_lengths
from greybox_torch.diagnosis.hypothesis.noise import reaches_noise
from greybox_torch.diagnosis.hypothesis.states_first import states_first
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget

SETTINGS, BUDGET = DiagnosisSettings(), SearchBudget()


@pytest.fixture
def search(motor_data, motor, begun):
    return begun(motor_data(noise=0.1), motor)


@pytest.fixture
def again(search):
    """:func:`states_first` on the longest windows of that search, given a fit of them."""
    return partial(
        states_first,
        search.problem,
        fits=search.plain.fits[:-1],
        simulator=search.plain.simulator,
        length=window_lengths(search.problem)[-1],
        limits=BUDGET.window_iterations,
        settings=SETTINGS,
        budget=BUDGET,
    )


@pytest.fixture
def lost(search):
    """The longest windows with an error of nine times the square, from parameters that are three times too large."""
    longest = search.plain.fits[-1]
    assert reaches_noise(search.problem, longest, SETTINGS)
    wrong = longest.problem.with_values(3 * longest.problem.values)
    return replace(longest, mean_square=9 * longest.mean_square, problem=wrong)


def test_long_windows_that_lost_the_way_begin_from_what_shorter_ones_found(search, again, lost) -> None:
    """Seen: a transmission error found at the noise over 1240 samples, lost over 4960, and so taken back on other experiments."""
    assert not reaches_noise(search.problem, lost, SETTINGS)
    found, longest = again(lost), search.plain.fits[-1]
    assert found.windows.steps == longest.windows.steps and reaches_noise(search.problem, found, SETTINGS)
    assert found.mean_square == pytest.approx(longest.mean_square, rel=1e-2)
    assert again(longest).mean_square <= longest.mean_square


@pytest.mark.parametrize("shorter_lead_there", [True, False])
def test_where_they_are_too_far_the_way_goes_by_windows_of_half_the_length(
    search, again, lost, shorter_lead_there, monkeypatch
) -> None:
    """Seen: an arm's play, found over windows of 312 samples, whose motion within the gap went another way in one of four of 1248."""
    begun_along, whole = [], module._along

    def along(shorter, problem, *how):
        begun_along.append(shorter.windows.steps)
        known = any(shorter is f for f in search.plain.fits)
        return [lost] if known and not shorter_lead_there else whole(shorter, problem, *how)

    monkeypatch.setattr(module, "_along", along)
    found = again(lost)
    assert reaches_noise(search.problem, found, SETTINGS)
    own = [f.windows.steps for f in search.plain.fits[:-1]]
    half = window_lengths(search.problem)[-1] // 2
    assert begun_along[: len(own)] == own
    assert len(begun_along) == len(own) + (not shorter_lead_there)
    assert shorter_lead_there or half <= begun_along[-1] < half + own[0]
    assert np.isfinite(found.starts).all()
