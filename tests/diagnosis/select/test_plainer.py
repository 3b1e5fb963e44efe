"""A law that differs by direction goes back to its plain form where another effect makes up for the difference."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.refit.ranked import judged
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select.backward import drop_superfluous
from greybox_torch.diagnosis.select.plainer import with_plainer_forms
from greybox_torch.diagnosis.select.state import SelectionStep
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.mechanisms.actuator import InputBias, TorqueSaturation
from greybox_torch.mechanisms.actuator_deadzone import ActuatorDeadzone
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.mechanisms.transmission_error import TransmissionError


def with_both(search, motor, low: float, high: float, bias: float):
    """The state of ``search`` after steps that took a dead zone, by direction, and an offset."""
    zone, offset = attach(motor, "actuator", ActuatorDeadzone(True)), attach(motor, "actuator", InputBias())
    width, asymmetry = (low + high) / 2, (high - low) / (high + low)
    start = {f"{zone.prefix}.half_width": width, f"{zone.prefix}.asymmetry": asymmetry}
    state, effects = search.state, ()
    for law, own in ((zone, start), (offset, {f"{offset.prefix}.bias": bias})):
        effects = (*effects, law)
        fitted = search.refitted(effects, state.current, [state.current.values() | start | own])
        taken = judged(Candidate(law, (), 0.5), state.current, fitted, search.study.settings)
        state = replace(state.at(fitted), steps=(*state.steps, SelectionStep((), state.current, (taken,), taken)))
    return state


def acting(low: float, high: float, bias: float):
    """The voltage that acts behind a dead zone from -low to high, with an offset."""
    return lambda v: np.maximum(v - high, 0.0) + np.minimum(v + low, 0.0) + bias


def test_a_difference_that_an_offset_makes_up_for_goes(motor_data, motor, begun) -> None:
    """Seen: a pendulum's dead zone of 22 mN m with an offset of 29, told as a zone on one side, the offset taken back as undone."""
    search = begun(motor_data(acting=acting(0.3, 0.3, 0.2)), motor)
    before = with_both(search, motor, 0.2, 0.4, 0.1)
    state = with_plainer_forms(search.study, before)
    zone, offset = state.effects
    assert isinstance(zone.mechanism, ActuatorDeadzone) and not zone.mechanism.by_direction
    values = state.current.values()
    assert values[f"{zone.prefix}.half_width"] == pytest.approx(0.3, rel=0.05)
    assert values[f"{offset.prefix}.bias"] == pytest.approx(0.2, rel=0.05)
    step = state.step_of(zone.prefix)
    assert step is not None and step.taken is not None and step.taken.fitted is state.current
    dropped = result_of(drop_superfluous(search.study, before))
    assert dropped.prefixes == state.prefixes and dropped.current.score == state.current.score


def test_a_difference_that_is_the_machines_stays(motor_data, motor, begun) -> None:
    search = begun(motor_data(acting=acting(0.15, 0.6, 0.2)), motor)
    before = with_both(search, motor, 0.15, 0.6, 0.2)
    assert with_plainer_forms(search.study, before) is before


def test_one_law_alone_was_asked_when_it_was_taken(motor_data, motor, begun) -> None:
    search = begun(motor_data(acting=acting(0.3, 0.3, 0.0)), motor)
    state = with_both(search, motor, 0.3, 0.3, 0.0)
    alone = state.at(state.steps[0].taken.fitted)
    assert with_plainer_forms(search.study, alone) is alone


@pytest.mark.parametrize("law", [TorqueSaturation, ActuatorDeadzone])
def test_the_plain_form_is_the_one_it_came_from(law) -> None:
    found = law(True).plainer({"limit": 2.0, "asymmetry": 0.3})
    assert found is not None
    plain, values = found
    assert type(plain) is law and not plain.by_direction and plain.plainer(values) is None and values == {"limit": 2.0}
    limited = TorqueSaturation(True, limited_power=True).plainer({})
    assert limited is not None and isinstance(limited[0], TorqueSaturation)
    assert limited[0].limited_power and not limited[0].by_direction
    assert InputBias().plainer({"bias": 1.0}) is None


@pytest.mark.parametrize("law", [TorqueRipple, TransmissionError])
def test_of_waves_it_is_the_strongest(law) -> None:
    values = {"a": 0.1, "b": 0.0, "a_2": -3.0, "b_2": 4.0, "a_3": 0.0, "b_3": 0.2, "order": 2.0}
    found = law(2.0, 3).plainer(values)
    assert found is not None
    plain, begun = found
    assert (plain.order, plain.harmonics) == (4.0, 1)
    assert begun == {"a": -3.0, "b": 4.0, "order": 4.0} and plain.plainer(begun) is None


def test_waves_that_were_taken_before_the_friction_become_the_one_that_is_there(motor_data, motor, begun) -> None:
    """Seen: a hoist's drum, four periods a turn, told as two with five harmonics (twelve amplitudes)."""
    turning = motor_data(torque=lambda q, v: 0.05 * np.cos(4 * q) - 0.02 * np.tanh(v / 0.05))
    search = begun(turning, motor)
    ripple, friction = attach(motor, "rotor", TorqueRipple(2.0, 3)), attach(motor, "rotor", CoulombFriction())
    state, effects = search.state, ()
    start = {f"{ripple.prefix}.a_2": 0.05, f"{friction.prefix}.F_c": 0.02, f"{friction.prefix}.v_0": 0.05}
    for law in (ripple, friction):
        effects = (*effects, law)
        fitted = search.refitted(effects, state.current, [state.current.values() | start])
        taken = judged(Candidate(law, (), 0.5), state.current, fitted, search.study.settings)
        state = replace(state.at(fitted), steps=(*state.steps, SelectionStep((), state.current, (taken,), taken)))
    plain = with_plainer_forms(search.study, state).effects[0]
    assert isinstance(plain.mechanism, TorqueRipple) and plain.mechanism.harmonics == 1
    values = with_plainer_forms(search.study, state).current.values()
    assert values[f"{plain.prefix}.order"] == pytest.approx(4.0, rel=0.01)
    amplitude = np.hypot(values[f"{plain.prefix}.a"], values[f"{plain.prefix}.b"])
    assert amplitude == pytest.approx(0.05, rel=0.1), "where the turn begins is not known"
