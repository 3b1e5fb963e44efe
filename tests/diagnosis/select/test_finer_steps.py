"""What was found is simulated in finer steps where its values ask for them and the fit is better so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.select import finer_steps as module
from greybox_torch.diagnosis.select.finer_steps import in_finer_steps
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.friction import CoulombFriction

WIDTH = 0.006
"""In rad/s: within it friction of 0.05 N m changes its sign, faster than one step a sample can follow."""


@pytest.fixture(scope="module")
def stiff(motor_data, motor, begun):
    """A motor whose friction changes its sign abruptly, and the search that found it, in one step per sample."""
    data = motor_data(torque=lambda q, v: -0.05 * np.tanh(v / WIDTH), noise=0.002)
    search = begun(data, motor)
    dry = attach(motor, "rotor", CoulombFriction())
    start = {f"{dry.prefix}.F_c": 0.05, f"{dry.prefix}.v_0": 0.05}
    fitted = search.refitted((dry,), search.plain, [search.plain.values() | start])
    return search.study, search.state.at(fitted), dry


@pytest.fixture
def left(monkeypatch):
    """How much more than noise is said to be left: the floor of this motor is high, for its speed jumps with the voltage."""
    return lambda times: monkeypatch.setattr(module, "times_noise", lambda problem, fitted, settings: times)


def test_the_width_that_one_step_a_sample_cannot_follow_is_found(stiff, left) -> None:
    study, state, dry = stiff
    left(5.0)
    finer = in_finer_steps(study, state)
    (effect,) = finer.effects
    assert effect.substeps > 1 and replace(effect, substeps=1) == dry
    assert finer.current.simulator.substeps == effect.substeps
    assert finer.current.score < state.current.score + np.log(study.budget.left_in_finer_steps)
    assert finer.current.values()[f"{dry.prefix}.v_0"] == pytest.approx(WIDTH, rel=0.1)
    assert in_finer_steps(study, finer) is finer, "fine enough now"


def test_nothing_is_asked_near_the_noise_or_where_nothing_is_gained(stiff, left) -> None:
    study, state, _ = stiff
    left(1.0)
    assert in_finer_steps(study, state) is state
    left(5.0)
    dear = replace(study, budget=replace(study.budget, left_in_finer_steps=0.1))
    assert in_finer_steps(dear, state) is state
    plain = state.at(state.plain)
    assert in_finer_steps(study, plain) is plain
