"""Candidates and start values from the measured motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch

from greybox_torch.data import ParameterEntry
from greybox_torch.diagnosis.screen.from_motion import candidates_from_motion
from greybox_torch.diagnosis.screen.regression import regressions
from greybox_torch.diagnosis.screen.shortlist import Candidate, with_motion
from greybox_torch.diagnosis.screen.views import Views, views_of
from greybox_torch.diagnosis.select.offered import from_motion
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.estimate.problem import make_problem
from greybox_torch.mechanisms.actuator import InputLag
from greybox_torch.mechanisms.attachment import Attachment, attach
from greybox_torch.mechanisms.forces import AdditionalMode, ConstantBias
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.sensor import SensorGain
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.systems.load import load_model


def test_friction_is_found_with_its_level_and_the_mass_as_it_is(rubbing) -> None:
    found = {c.attachment.mechanism.name: c for c in candidates_from_motion(rubbing.study, rubbing.problem)}
    assert found["coulomb_friction"].explained > 0.9
    start = found["coulomb_friction"].starts[0]
    assert start["sled.coulomb_friction.F_c"] == pytest.approx(1.5, rel=0.03)
    assert start["m"] == pytest.approx(2.5, rel=0.03)


def test_a_model_without_free_parameters_is_compared_as_well(sled_run, machines, rubbing) -> None:
    model, known = load_model(f"{machines / 'sled.py'}:Sled"), {"m": (2.5, True), "c": (0.8, True)}
    data = sled_run(lambda q, v: -1.5 * np.tanh(v / 0.02))
    entries = {n: ParameterEntry(value=v, fixed=fixed) for n, (v, fixed) in known.items()}
    problem = make_problem(replace(data, parameters=entries), model, data.estimation())
    study = replace(rubbing.study, problem=problem)
    found = candidates_from_motion(study, problem)
    start = next(c.starts[0] for c in found if isinstance(c.attachment.mechanism, CoulombFriction))
    assert start["sled.coulomb_friction.F_c"] == pytest.approx(1.5, rel=0.03)


def test_what_is_in_the_hypothesis_is_not_offered_again(rubbing) -> None:
    effect = attach(rubbing.problem.model, "sled", CoulombFriction())
    rubbed = rubbing.refitted((effect,), rubbing.current)
    again = from_motion(rubbing.study, rubbing.at(rubbed).state)
    assert "coulomb_friction" not in {c.attachment.mechanism.name for c in again}


def test_a_model_that_lacks_nothing_gives_no_candidates(whole) -> None:
    assert candidates_from_motion(whole.study, whole.problem) == []
    every = replace(whole.study, settings=DiagnosisSettings(least_left_of_motion=0.0))
    assert candidates_from_motion(every, whole.problem) == [], "however little is left"


def test_ripple_is_found_at_its_order(sled_run, begun, machines) -> None:
    data = sled_run(lambda q, v: 0.6 * np.cos(47.0 * q + 0.3), travel=2.0, experiments=1)
    rippled = begun(data, load_model(f"{machines / 'sled.py'}:Sled"))
    found = candidates_from_motion(rippled.study, rippled.problem)
    start = next(c.starts[0] for c in found if isinstance(c.attachment.mechanism, TorqueRipple))
    assert start["sled.torque_ripple.order"] == pytest.approx(47.0, rel=0.01)
    assert np.hypot(start["sled.torque_ripple.a"], start["sled.torque_ripple.b"]) == pytest.approx(0.6, rel=0.1)


def test_where_sensors_do_not_show_the_motion_nothing_is_added(arm_search) -> None:
    assert isinstance(arm_search.study.motion, str)
    assert candidates_from_motion(arm_search.study, arm_search.problem) == []


def test_laws_with_a_memory_and_sensors_are_not_regressed(rubbing) -> None:
    views = views_of(rubbing.problem)
    assert isinstance(views, Views)
    model = rubbing.problem.model
    places = [("actuator", InputLag()), ("sled", AdditionalMode()), ("sensor", SensorGain()), ("sled", ConstantBias())]
    offered = [attach(model, port, law) for port, law in places]
    found = regressions(views, (), offered, rubbing.surroundings)
    assert all({r.score.attachment.mechanism.name for r in row} == {"constant_bias"} for row in found)


class WithinHalf(ConstantBias):
    """A bias that is no number above 0.5 in its unit, as a dead zone is that leaves nothing of an input that divides."""

    name = "within_half"

    def force(self, s, p, z):
        return p.bias / torch.sqrt(0.5 - p.bias)


@pytest.mark.filterwarnings("error")
def test_a_law_is_regressed_by_a_step_that_leads_to_numbers(rubbing) -> None:
    """Seen: a step of 1 m of the dead zone of a rope of 0.9 m; nan, and NumPy's warnings, in the regression."""
    views = views_of(rubbing.problem)
    assert isinstance(views, Views)
    model, laws = rubbing.problem.model, (ConstantBias(), WithinHalf())
    found = regressions(views, (), [attach(model, "sled", law) for law in laws], rubbing.surroundings)
    for plain, within in (row for row in found):
        assert within.score.explained == pytest.approx(plain.score.explained, rel=1e-6)
        np.testing.assert_allclose(within.score.size, np.sqrt(0.5) * plain.score.size, rtol=1e-2)


def test_a_hypothesis_with_a_memory_is_not_compared_with_the_motion(rubbing) -> None:
    lagged = rubbing.refitted((attach(rubbing.problem.model, "actuator", InputLag()),), rubbing.current)
    assert views_of(lagged.problem) == "no output shows actuator.input_lag.lagged"
    assert candidates_from_motion(rubbing.study, lagged.problem, lagged.effects) == []


def test_start_values_join_those_of_the_screen() -> None:
    one, two, three = ({"m": v} for v in (1.0, 2.0, 3.0))
    coulomb, bias = (
        Candidate(a, (one, one), 0.5) for a in (Attachment("sled", law) for law in (CoulombFriction(), ConstantBias()))
    )
    both = with_motion([coulomb], [replace(coulomb, starts=(two,)), replace(bias, starts=(three,))])
    assert [c.attachment.mechanism.name for c in both] == ["coulomb_friction", "constant_bias"]
    assert both[0].first_starts(1) == (one, two)
    assert both[1].first_starts(2) == (three,)
