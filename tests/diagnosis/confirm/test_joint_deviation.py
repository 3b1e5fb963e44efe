"""Whether all amplitudes of an effect together are more than chance."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm.joint_deviation import within_one_deviation
from greybox_torch.estimate.uncertainty import Uncertainty
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.end_stop import EndStop
from greybox_torch.mechanisms.gravity import Gravity
from greybox_torch.mechanisms.mechanism import Range, Surroundings

AROUND = {"arm": Surroundings({"position": Range(-1.0, 1.0, 0.5), "speed": Range(-2.0, 2.0, 1.0)}, {}, "N m", 1e-3)}


@pytest.fixture
def final(stub) -> Any:
    def make(effect: Attachment, values: dict[str, float], covariance: np.ndarray, undetermined=(), larger=1.0) -> Any:
        names = ("J", *(f"{effect.prefix}.{n}" for n in values))
        whole = np.zeros((len(names), len(names)))
        whole[0, 0] = 1.0
        whole[1:, 1:] = covariance
        known = {"J": 1.0, **{f"{effect.prefix}.{n}": v for n, v in values.items()}}
        told = Uncertainty(whole, larger * whole, undetermined)
        return stub(problem=stub(free_names=names), uncertainty=told, values=lambda: known)

    return make


WEIGHT, STOP = Attachment("arm", Gravity()), Attachment("arm", EndStop())


def test_two_amplitudes_of_which_neither_is_seen_are_chance(final) -> None:
    """Seen: weight of -0.003 +- 0.011 and 0.001 +- 0.012 N m beside a gear's play with impacts, told with 0.94."""
    found = final(WEIGHT, {"a": -0.0027, "b": 0.0011}, np.diag([0.0106, 0.0117]) ** 2)
    assert within_one_deviation(found, WEIGHT, AROUND)
    assert not within_one_deviation(
        final(WEIGHT, {"a": -0.1, "b": 0.0}, np.diag([0.0106, 0.0117]) ** 2), WEIGHT, AROUND
    )


def test_amplitudes_that_trade_for_one_another_are_seen_together(final) -> None:
    """Seen: a hard stop of 93 +- 3700 N/m and a damping as little determined, that removed 99.9 % of the error."""
    deviations, correlation = np.array([3700.0, 37.0]), np.array([[1.0, -0.9999999], [-0.9999999, 1.0]])
    covariance = np.outer(deviations, deviations) * correlation
    assert not within_one_deviation(final(STOP, {"k": 93.0, "c": 3.0}, covariance), STOP, AROUND)
    assert within_one_deviation(final(STOP, {"k": 93.0, "c": 3.0}, np.diag(deviations) ** 2), STOP, AROUND)


def test_the_larger_covariance_counts(final) -> None:
    values, covariance = {"a": 0.03, "b": 0.0}, np.diag([0.01, 0.01]) ** 2
    assert not within_one_deviation(final(WEIGHT, values, covariance), WEIGHT, AROUND)
    assert within_one_deviation(final(WEIGHT, values, covariance, larger=9.0), WEIGHT, AROUND)


def test_where_nothing_is_known_nothing_is_said(final, stub) -> None:
    values, covariance = {"a": 1e-9, "b": 0.0}, np.eye(2)
    assert within_one_deviation(final(WEIGHT, values, covariance), WEIGHT, AROUND)
    assert not within_one_deviation(final(WEIGHT, values, covariance, undetermined=(1,)), WEIGHT, AROUND)
    found = final(WEIGHT, values, covariance)
    unfitted = stub(problem=found.problem, uncertainty=None, values=found.values)
    assert not within_one_deviation(unfitted, WEIGHT, AROUND)
