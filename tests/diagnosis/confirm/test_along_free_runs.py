"""Held-out windows that begin where the free run passes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm import held_out
from greybox_torch.diagnosis.confirm.along_free_runs import along_free_runs, free_run_states
from greybox_torch.diagnosis.confirm.held_out import HeldOut, _no_worse_than_free_runs
from greybox_torch.diagnosis.hypothesis.noise import noise_floor
from greybox_torch.diagnosis.settings import SearchBudget
from greybox_torch.estimate.initial import estimate_initial
from greybox_torch.simulation.windows import cut


@pytest.fixture
def judge(motor_data, motor, begun):
    """A motor's plain model that is right, its search, and what judges it on other experiments."""
    data = motor_data(torque=lambda q, v: 0.0)
    search = begun(data, motor)
    return search, HeldOut(data, search.study)


@pytest.fixture
def started(judge):
    """The held-out experiments, start states estimated on their first tenth."""
    search, others = judge
    values = np.array([search.plain.values()[n] for n in others.problem.names])
    return estimate_initial(others.problem.with_values(values), search.plain.simulator)


def test_windows_begin_on_the_free_run_and_end_at_the_noise(judge, started) -> None:
    search, others = judge
    windows = cut(started.records, 40)
    states = free_run_states(started, search.plain.simulator, windows)
    assert states is not None and states.shape == (len(windows.start), len(started.model.states))
    assert np.allclose(states[0], started.initial[0])
    fit = along_free_runs(started, search.plain.simulator, 40, SearchBudget())
    assert fit is not None and fit.mean_square < 1.2 * noise_floor(started, search.study.settings)


def test_start_states_that_overflow_do_not_make_a_hypothesis_impossible(judge, monkeypatch) -> None:
    """Nothing could be said of a right law on held-out experiments where the measurements of no window suggest its start."""
    search, others = judge
    usual = others.fits(search.plain)
    monkeypatch.setattr(held_out, "placed", lambda *_, **__: None)
    found = others.fits_at(search.plain, search.plain.values())
    assert len(found) == len(usual) > 0
    for one, other in zip(found, usual, strict=True):
        assert one.mean_square == pytest.approx(other.mean_square, rel=0.05)


def test_a_window_in_a_local_minimum_is_begun_again_where_the_free_run_passes(judge, started) -> None:
    search, _ = judge
    simulator, budget = search.plain.simulator, SearchBudget()
    right = along_free_runs(started, simulator, 40, budget)
    astray = np.where(np.arange(len(right.energies)) == 1, 10.0, 1.0) * right.energies
    best = _no_worse_than_free_runs(replace(right, energies=astray), started, simulator, 40, budget)
    assert best.energies == pytest.approx(right.energies, rel=1e-3)
    assert _no_worse_than_free_runs(None, started, simulator, 40, budget) is None
