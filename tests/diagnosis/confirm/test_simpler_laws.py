"""A law that another one contains is asked in as fine steps as it needs."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm.simpler_laws import _contained
from greybox_torch.diagnosis.refit.ranked import judged
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select import finer_steps
from greybox_torch.diagnosis.select.state import SelectionStep
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.presliding import PreslidingHysteresis

WIDTH = 0.006
"""In rad/s: within it friction of 0.05 N m changes its sign, faster than one step a sample can follow."""


@pytest.mark.parametrize(("times", "finer"), [(5.0, True), (1.0, False)], ids=["much is left", "noise is left"])
def test_dry_friction_that_changes_its_sign_within_a_step_is_asked_in_finer_ones(
    monkeypatch, motor_data, motor, begun, times, finer
) -> None:
    """Seen: a press's dry friction, told as presliding of 18 um (0.97): in one step a sample it left eight times the error."""
    search = begun(motor_data(torque=lambda q, v: -0.05 * np.tanh(v / WIDTH), noise=0.002), motor)
    ranked = []
    for law, values in ((PreslidingHysteresis(), {"F": 0.05}), (CoulombFriction(), {"F_c": 0.05, "v_0": 0.05})):
        effect = attach(motor, "rotor", law)
        start = search.plain.values() | {f"{effect.prefix}.{n}": v for n, v in values.items()}
        fitted = search.refitted((effect,), search.plain, [start])
        ranked.append(judged(Candidate(effect, (), 0.9), search.plain, fitted, search.study.settings))
    state = search.at(ranked[0].fitted, steps=(SelectionStep((), search.plain, tuple(ranked), ranked[0]),)).state
    monkeypatch.setattr(finer_steps, "times_noise", lambda problem, fitted, settings: times)
    ((rival, fitted),) = _contained(search.study, state, state.effects[0])
    assert rival is ranked[1] and fitted.effects[0].mechanism.name == "coulomb_friction"
    assert (fitted.effects[0].substeps > 1) is finer
    if finer:
        assert fitted.score < rival.fitted.score - 0.5
        assert fitted.values()["rotor.coulomb_friction.v_0"] == pytest.approx(WIDTH, rel=0.1)
