"""How large the mismatch is beside the motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.hypothesis.mismatch import least_mismatch, mismatch_share
from greybox_torch.diagnosis.select.search import search
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.stopping import result_of


def test_the_error_beyond_the_noise_in_units_of_the_spread(motor, begun, motor_data) -> None:
    plain = begun(motor_data(noise=0.1), motor).plain
    spread = float(np.std(plain.problem.records.y))
    larger = replace(plain, fits=tuple(replace(fit, mean_square=0.01 + (0.3 * spread) ** 2) for fit in plain.fits))
    assert mismatch_share(larger, DiagnosisSettings()) == pytest.approx(0.3, rel=0.02)
    silent = replace(plain, fits=tuple(replace(fit, mean_square=1e-3) for fit in plain.fits))
    assert mismatch_share(silent, DiagnosisSettings()) == 0.0


def test_nothing_is_looked_for_where_simulations_differ_by_as_much(dead_zone_search) -> None:
    found = dead_zone_search
    share = mismatch_share(found.plain, found.study.settings)
    assert share > found.study.settings.least_mismatch
    coarse = replace(found.study, settings=replace(found.study.settings, least_mismatch=min(1.0, 1.1 * share)))
    assert result_of(search(coarse, found.state)).steps == ()


def test_nor_where_a_shift_by_a_part_of_the_sampling_interval_does_as_much(dead_zone_search) -> None:
    found = dead_zone_search
    share, study = mismatch_share(found.plain, found.study.settings), found.study
    records = study.problem.records
    steps = np.concatenate([np.diff(records.y[0, records.span(e)]) for e in range(len(records.first))])
    noise = 0.02
    shift = 0.05 * float(np.sqrt(np.mean(steps**2) - 2 * noise**2) / np.std(records.y))
    lenient = replace(study, settings=replace(study.settings, most_of_shift=1.0))
    assert least_mismatch(lenient) == pytest.approx(shift, rel=0.05)
    assert least_mismatch(study) == pytest.approx(min(least_mismatch(lenient), 1e-3))
    shifted = replace(study, settings=replace(study.settings, least_shift=1.0, most_of_shift=1.0))
    assert (share < least_mismatch(shifted)) == (result_of(search(shifted, found.state)).steps == ())
    turn = np.sin(2 * np.pi * np.arange(records.y.shape[1]) / 1000)[None]
    recorded = replace(study, recorded=replace(records, y=turn))
    assert least_mismatch(recorded) == pytest.approx(0.05 * 2 * np.pi / 1000, rel=0.01), "of what was recorded"
