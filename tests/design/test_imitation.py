"""What a rival cannot imitate, however far its parameters have to go."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.api.design import _contender
from greybox_torch.api.hypotheses import hypotheses_of
from greybox_torch.experiment_design.contender import Contender
from greybox_torch.experiment_design.imitation import not_imitated
from greybox_torch.experiment_design.separation import evidence
from greybox_torch.experiment_design.side_by_side import records_of

VOLTAGE = np.repeat([2.0, -2.0, 1.0, -1.0], 50)[None]


@pytest.fixture(scope="module")
def both(undecided) -> tuple[Contender, Contender]:
    """Dry friction, and a constant torque."""
    held = hypotheses_of(undecided)
    friction, torque = (_contender(kept, held) for kept in held.findings[0])
    return friction, torque


def left(right: Contender, rival: Contender) -> tuple[float, float]:
    """What the rival cannot imitate of the right one on reversing steps: by its slopes alone, and estimated anew."""
    records = records_of([VOLTAGE], rival.problem.records, 0.01)
    outputs, first = right.predicted(records).y[0], rival.predicted(records)
    assert first.slopes is not None
    slopes = first.slopes[0].reshape(-1, first.slopes.shape[-1]) / rival.level
    known = np.zeros((slopes.shape[1],) * 2)
    known[: len(rival.information), : len(rival.information)] = rival.information
    linear = evidence(((outputs - first.y[0]) / rival.level).ravel(), slopes, known)
    return linear, not_imitated([outputs], rival, records, rival.level)[0]


def test_what_other_values_do_is_imitated_where_nothing_is_known_of_them(both) -> None:
    torque = both[1]
    unknown = replace(torque, information=np.zeros_like(torque.information))
    far = torque.problem.values * np.array([2.5 if name == "J" else 1.0 for name in torque.problem.names])
    linear, anew = left(torque.at(far), unknown)
    assert linear > 100.0 and anew < 0.05


def test_what_is_known_keeps_it_from_imitating(both) -> None:
    torque = both[1]
    far = torque.problem.values * np.array([1.2 if name == "J" else 1.0 for name in torque.problem.names])
    assert left(torque.at(far), torque)[1] > 10.0


def test_another_law_is_not_imitated_where_the_machine_reverses(both) -> None:
    friction, torque = both
    _, anew = left(friction, torque)
    assert anew > 100.0


def test_a_start_state_of_its_own_is_no_evidence(both) -> None:
    torque = both[1]
    records = records_of([VOLTAGE], torque.problem.records, 0.01)
    first = torque.predicted(records)
    elsewhere = torque.predicted(records, start=first.start[0] + 1.5)
    assert np.abs(elsewhere.y - first.y).max() == pytest.approx(1.5)
    assert not_imitated([elsewhere.y[0]], torque, records, torque.level)[0] < 0.05


def test_side_by_side_is_one_by_one(both) -> None:
    """Several outputs, on records and from parameters of their own, in the lanes of one pass: to the last digit what each gives alone."""
    friction, torque = both
    inputs = [VOLTAGE, 0.4 * VOLTAGE, VOLTAGE[:, ::-1]]
    values = np.array([friction.problem.values * f for f in (1.0, 1.1, 0.9)])
    records = records_of(inputs, torque.problem.records, 0.01)
    rights = friction.predicted(records, tangents=False, values=values).y
    found = not_imitated(list(rights), torque, records, torque.level)
    for k, u in enumerate(inputs):
        alone = records_of([u], torque.problem.records, 0.01)
        np.testing.assert_array_equal(friction.at(values[k]).predicted(alone, tangents=False).y[0], rights[k])
        assert found[k] == not_imitated([rights[k]], torque, alone, torque.level)[0] > 1.0
