"""Estimates far from where they began, of a model that simulates badly, are told in a sentence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.api.far_parameters import far_parameters
from greybox_torch.api.ran_away import by_one_factor, start_values
from greybox_torch.estimate.fit import Estimation
from greybox_torch.estimate.metrics import told_fit
from tests.api.motor import Motor
from tests.api.test_fit_many import motors


@pytest.fixture(scope="module")
def fitted() -> tuple[Estimation, gt.DataSet]:
    (data,) = motors(1)
    own = gt.DataSet(data.recordings, parameters={"J": {"value": 0.02}})
    return gt.fit(Motor(), own).estimation, own


def at(found: Estimation, name: str, value: float) -> Estimation:
    values = np.where(np.array(found.problem.names) == name, value, found.problem.values)
    return replace(found, problem=replace(found.problem, values=values))


@pytest.mark.parametrize(("value", "fit", "told"), [
    (0.8, 20.0, True), (0.0005, 20.0, True), (0.8, -42.0, True), (0.8, -12345.0, True), (0.8, -np.inf, True),
    (0.8, 99.0, False), (0.03, 20.0, False), (1e87, 20.0, False),
])  # fmt: skip
def test_of_a_poor_fit_alone(fitted: tuple[Estimation, gt.DataSet], value: float, fit: float, told: bool) -> None:
    """Seen: a carriage of 271 kg, begun with 8, where dry friction was left out, and no word of it; what ran away is told elsewhere."""
    found = far_parameters(at(fitted[0], "J", value), fitted[1], fit)
    assert (found is not None) is told
    if found is not None:
        assert found.startswith(
            f"Ended far from where it began: J = {value:.4g} kg m^2 (begun with 0.02). With a mean fit of {told_fit(fit, 1)} "
        )
        assert "inf" not in found and "e+" not in found, "seen: -inf %, -1.23e+04 %"


def test_at_a_bound_it_is_told_elsewhere(fitted: tuple[Estimation, gt.DataSet]) -> None:
    estimation, data = fitted
    low = np.where(np.array(estimation.problem.names) == "J", 0.0005, estimation.problem.lower)
    held = replace(estimation, problem=replace(estimation.problem, lower=low))
    for rounded in (0.0005, 0.0005 * (1.0 + 1e-15)):
        assert far_parameters(at(held, "J", rounded), data, 20.0) is None


@pytest.mark.parametrize(
    ("times", "told"),
    [
        (1000.0, ", all of them by about 1000 times, as"),
        (1.0 / 57.3, ", all of them by about 1/56, as"),
        (-1000.0, ""),
    ],
)
def test_that_all_went_by_one_factor_points_to_an_input(
    fitted: tuple[Estimation, gt.DataSet], times: float, told: str
) -> None:
    """Seen: a current in mA, read as A: five parameters were told, each 1000 times too large, and not what explains them all."""
    estimation, data = fitted
    begun, found = start_values(estimation, data), estimation
    names = [n for n in estimation.problem.names if begun[n] != 0.0]
    assert len(names) >= 3
    for name, scatter in zip(names, np.resize([0.9, 1.0, 1.2], len(names)), strict=True):
        found = at(found, name, times * scatter * begun[name])
    assert by_one_factor(found, data, names).startswith(told) and bool(by_one_factor(found, data, names)) is bool(told)
    assert by_one_factor(found, data, names[:2]) == "", "of two it may be chance"
    apart = at(found, names[0], 5.0 * times * begun[names[0]])
    assert by_one_factor(apart, data, names) == ""
