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
from greybox_torch.mechanisms.actuator import ActuatorDeadzone, InputBias, TorqueSaturation
from greybox_torch.mechanisms.attachment import attach


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
    plain = law(True).plainer()
    assert type(plain) is law and not plain.by_direction and plain.plainer() is None
    limited = TorqueSaturation(True, limited_power=True).plainer()
    assert isinstance(limited, TorqueSaturation) and limited.limited_power and not limited.by_direction
    assert InputBias().plainer() is None
