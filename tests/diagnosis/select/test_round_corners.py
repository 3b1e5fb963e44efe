"""A law takes a form with more parameters where it leaves hardly more than noise, and the form noise alone."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.refit.ranked import judged
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select import richer
from greybox_torch.diagnosis.select.richer import _pays, with_richer_form
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.mechanisms.actuator_deadzone import ActuatorDeadzone
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.torque_ripple import TorqueRipple

from ..conftest import found


@pytest.mark.parametrize(("corner", "soft"), [(0.15, True), (0.0, False)])
def test_a_dead_band_with_round_corners(motor_data, motor, begun, corner, soft) -> None:
    """Seen: a wheelchair's drive, told as a curve over its input, though sharp corners left hardly more than noise."""

    def acting(v):
        if not corner:
            return v - np.clip(v, -0.3, 0.3)
        return corner * (np.logaddexp(0.0, (v - 0.3) / corner) - np.logaddexp(0.0, (-v - 0.3) / corner))

    search = begun(motor_data(acting=acting, noise=0.01), motor)
    zone = attach(motor, "actuator", ActuatorDeadzone())
    before = found(search, zone, {f"{zone.prefix}.half_width": 0.3})
    state = result_of(with_richer_form(search.study, before))
    (effect,) = state.effects
    assert isinstance(effect.mechanism, ActuatorDeadzone)
    assert effect.mechanism.soft is soft and not effect.mechanism.by_direction, "no more parameters than are asked for"
    if soft:
        assert state.current.score < before.current.score
        assert 0.1 < state.current.values()[f"{zone.prefix}.softness"] < 0.7


@pytest.mark.parametrize(("alone", "taken"), [(True, True), (False, False)])
def test_a_form_that_leaves_white_noise_alone_pays_as_a_curve_would(
    monkeypatch, motor_data, motor, begun, alone, taken
) -> None:
    """The wheelchair's dead band once more: its curve stood before the name for that reason."""
    search = begun(motor_data(torque=lambda q, v: 0.06 * np.sin(2.5 * q)), motor)
    ripple = attach(motor, "rotor", TorqueRipple(2.5))
    state, settings = found(search, ripple, {f"{ripple.prefix}.b": 0.06}), search.study.settings
    asked: list[Any] = []
    monkeypatch.setattr(richer, "alone_at_noise", lambda *given: asked.append(given) or alone)
    ranked = replace(judged(Candidate(ripple, (), 0.5), state.current, state.current, settings), significance=5.0)
    assert ranked.gain == 0.0 and _pays(search.study, state, ranked) is taken
    assert asked == [(ranked.fitted, state.current, state.plain, settings)]
