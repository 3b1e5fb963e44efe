"""The screen: what is there explains most of what is left."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from greybox_torch.diagnosis.screen.candidates import candidates
from greybox_torch.diagnosis.screen.score_test import Screen, ScreenScore
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.torque_ripple import TorqueRipple


@pytest.fixture(scope="module")
def screen(dead_zone_search) -> Screen:
    search = dead_zone_search
    offered = [
        *candidates(search.problem.model, search.shifts, search.surroundings, flexible=False),
        *candidates(search.problem.model, search.shifts, search.surroundings, flexible=True),
    ]
    return Screen.of(
        search.problem.model, (), offered, search.surroundings, search.problem.free_names, search.study.options
    )


@pytest.fixture(scope="module")
def looks(dead_zone_search, screen) -> list[list[ScreenScore]]:
    return [screen.scores(fit) for fit in dead_zone_search.plain.fits]


def test_the_effect_that_is_there_explains_most(looks) -> None:
    for at_length in looks:
        best = {}
        for score in at_length:
            name = score.attachment.mechanism.name
            best[name] = max(best.get(name, -np.inf), score.explained)
        ranked = sorted(best, key=lambda name: -best[name])
        assert best["actuator_deadzone"] > 0.6
        assert "actuator_deadzone" in ranked[:2], "at most a free curve at the same place explains more"
        assert all(best[name] < 0.5 for name in ("end_stop", "torque_ripple", "input_delay", "input_bias"))


def test_shares_are_shares(looks) -> None:
    for score in (score for at_length in looks for score in at_length):
        assert np.isfinite(score.size).all() and len(score.size) == len(score.probe.directions)
        assert -1e-6 < score.explained <= 1.0


def test_what_a_parameter_takes_up_already_explains_nothing(looks) -> None:
    """Viscous friction and a gain of the input are the motor's own b and k / J: projected out."""
    taken = [score for at in looks for score in at if score.attachment.mechanism.name == "viscous_friction"]
    assert taken and all(abs(score.explained) < 0.01 for score in taken)


def test_size_of_the_effect_is_near_the_truth(looks) -> None:
    """At zero width the tangent is that of a bias against the sign of the voltage: its size is the half width."""
    for at_length in looks:
        (score,) = [
            x
            for x in at_length
            if x.attachment.mechanism.name == "actuator_deadzone" and x.probe.directions == ("half_width",)
        ]
        assert score.size[0] == pytest.approx(0.5, rel=0.25)


def test_no_effect_no_share(motor_data, motor, begun, screen) -> None:
    clean = begun(motor_data(), motor)
    explained = [score.explained for fit in clean.plain.fits[:1] for score in screen.scores(fit)]
    assert max(explained) < 0.02


def test_memories_of_accepted_effects_are_not_taken_for_positions(motor_data, motor, begun) -> None:
    """A screen adds positions before the memories of effects that are there already: a ripple beside a lag is still seen."""
    data = motor_data(torque=lambda q, v: 0.04 * np.cos(7.0 * q + 0.7), acting=lambda v: lfilter([0.2], [1.0, -0.8], v))
    search = begun(data, motor)
    lag = attach(motor, "actuator", LIBRARY["input_lag"]())
    fitted = search.refitted((lag,), search.current, [{"actuator.input_lag.T": 0.045}])
    assert fitted is not None
    offered = [attach(motor, "rotor", TorqueRipple(7.0))]
    screen = Screen.of(motor, (lag,), offered, search.surroundings, fitted.problem.free_names, search.study.options)
    assert max(score.explained for score in screen.scores(fitted.fits[0])) > 0.5
