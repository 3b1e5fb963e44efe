"""How large the mismatch is beside the motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.hypothesis.mismatch import mismatch_share
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
