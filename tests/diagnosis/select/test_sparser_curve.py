"""A curve without the bumps that the recordings do not ask for."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.hypothesis.fit import hypothesis
from greybox_torch.diagnosis.select.sparser_curve import with_sparser_curve
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.unknown import Unknown

KNOTS = 12


@pytest.fixture(scope="session")
def drawn(motor_data, motor, begun):
    """A search whose current hypothesis is a curve over speed, of a motor with a torque of position and speed."""

    def draw(torque, noise):
        search = begun(motor_data(torque=torque, noise=noise), motor)
        curve = attach(motor, "rotor", Unknown("speed", KNOTS))
        start = search.plain.values() | {f"{curve.prefix}.w_{k}": 0.01 for k in range(KNOTS)}
        found = hypothesis(search.problem, (curve,), search.surroundings, [start], options=search.study.options)
        assert found is not None
        return search.at(found), curve

    return draw


def test_a_narrow_bump_leaves_the_curve_zero_elsewhere(drawn) -> None:
    """Seen: a notch in the way of a stage, and forces of a tenth of it where nothing is, with which nearly resting motion drifted."""
    search, curve = drawn(lambda q, v: -0.05 * np.exp(-(((v - 2.0) / 0.8) ** 2)), 0.1)
    found = result_of(with_sparser_curve(search.study, search.state))
    (effect,) = found.effects
    law = effect.mechanism
    assert isinstance(law, Unknown) and effect.prefix == curve.prefix
    assert 1 <= len(law.bumps) < KNOTS / 2
    centres = law.centres(search.surroundings["rotor"])
    assert all(abs(centres[k] - 2.0) < 2.5 for k in law.bumps)
    settings = search.study.settings
    assert found.current.score < search.current.score + settings.curve_margin < search.plain.score
    assert not found.compared_without


def test_a_curve_of_which_all_counts_stays_as_it_is(drawn) -> None:
    search, _ = drawn(lambda q, v: -0.05 * np.sin(1.5 * v), 0.01)
    found = result_of(with_sparser_curve(search.study, search.state))
    (effect,) = found.effects
    assert isinstance(effect.mechanism, Unknown) and len(effect.mechanism.bumps) >= KNOTS - 3


def test_without_a_curve_nothing_changes(dead_zone_search) -> None:
    search = dead_zone_search
    assert result_of(with_sparser_curve(search.study, search.state)) is search.state
