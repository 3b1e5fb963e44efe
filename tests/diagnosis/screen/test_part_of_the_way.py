"""Curves over a part of where a body goes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.beliefs import Beliefs
from greybox_torch.diagnosis.screen.first_few import first_few
from greybox_torch.diagnosis.screen.part_of_the_way import curves_over_parts
from greybox_torch.diagnosis.screen.score_test import ScreenScore
from greybox_torch.diagnosis.select.offered import screen_scores
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.mechanism import Probe
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.systems import RobotArm

AT, WIDTH, START = 5.0, 0.1, 0.4
"""Where the motor meets more resistance and along how much of its way, and where it begins, in rad; the model counts from there."""


@pytest.fixture(scope="module")
def notched(motor_data, motor, begun):
    """A motor that meets a notch in a place that it passes again and again, before the first look."""
    return begun(motor_data(torque=lambda q, v: -0.5 * np.exp(-(((q - AT) / WIDTH) ** 2))), motor)


def test_the_part_with_the_notch_explains_most_over_short_windows(notched) -> None:
    (score,) = curves_over_parts(notched.study, (), notched.state.current.fits)[0]
    law = score.attachment.mechanism
    assert score.attachment.port == "rotor" and law.knots == notched.study.budget.knots_of_part
    assert law.part[0] < AT - START < law.part[1] and law.part[1] - law.part[0] < 1.0
    assert score.explained > 0.9 and min(score.size) < -0.1, "a resistance"
    assert {p.name for p in law.parameters(notched.surroundings["rotor"]) if not p.fixed} == set(score.probe.directions)


@pytest.mark.parametrize(("most", "offered"), [(0.5, True), (0.01, False)])
def test_it_is_offered_where_it_leaves_much_less_than_curves_of_few_knots(notched, most, offered) -> None:
    study = replace(notched.study, settings=replace(notched.study.settings, left_by_narrow=most, screen_complete=1.0))
    shortest, *_ = screen_scores(study, notched.state, curves=True, fine=False)
    found = [s for s in shortest if isinstance(s.attachment.mechanism, Unknown) and s.attachment.mechanism.part]
    assert bool(found) is offered


def test_it_is_not_offered_where_the_user_knows_that_nothing_is_missing(notched) -> None:
    study = replace(notched.study, beliefs=Beliefs({"rotor/unknown": 0.0}))
    assert not any(curves_over_parts(study, (), notched.state.current.fits))


@pytest.mark.parametrize(("share", "passed_on"), [(0.9, True), (0.7, False)])
def test_parts_of_other_bodies_that_explain_nearly_as_much_are_passed_on(stub, share, passed_on) -> None:
    """Seen: a notch of a motor, told at the arm: it explained 82 % and the gearbox' curve 84 %, and refits of it alone go to the noise."""

    arm = RobotArm()

    def score(port: str, explained: float, part: tuple[float, float] | None) -> ScreenScore:
        curve = attach(arm, port, Unknown("position", 10, part=part))
        return ScreenScore(curve, Probe(("w_0",)), 31, explained, np.ones(1))

    first, beside = score("gearbox", 0.8, (31.0, 34.0)), score("motor", share * 0.8, (31.5, 34.5))
    along = score("arm", 0.79, None)
    study = stub(settings=DiagnosisSettings(), budget=SearchBudget(), problem=stub(model=arm))
    kept = first_few(study, [first, along, beside])
    assert kept[0] is first and any(one is beside for one in kept) is passed_on
    assert all(one is not along for one in kept)
