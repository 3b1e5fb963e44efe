"""An offset for errors that hardly exceed the noise is what a slow disturbance makes."""

from __future__ import annotations

import math

import pytest

from greybox_torch.diagnosis.confirm.holding import _within_disturbances
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.actuator import InputGain
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import ViscousFriction


@pytest.mark.parametrize(
    ("law", "rival", "gain", "times", "taken_back"),
    [
        (InputGain(), ConstantBias(), 0.030, 1.1, True),
        (InputGain(), ConstantBias(), 0.020, 1.1, False),
        (InputGain(), ViscousFriction(), 0.031, 1.1, False),
        (InputGain(), ConstantBias(), 0.030, 1.4, False),
        (ConstantBias(), ViscousFriction(), 0.0, 1.1, True),
        (InputGain(), ConstantBias(), 0.030, math.nan, False),
    ],
    ids=["as good", "worse", "no offset", "above the noise", "an offset itself", "no noise known"],
)
def test_what_an_offset_does_as_well_has_to_show_in_free_runs(stub, law, rival, gain, times, taken_back) -> None:
    """Seen: a complete power transformer, told as a gain of its load or an offset of its losses (0.97)."""
    effect = stub(prefix="oil.law", mechanism=law)
    taken = stub(gain=0.032)
    other = stub(gain=gain, candidate=stub(attachment=stub(mechanism=rival)))
    step = stub(taken=taken, ranked=(other,))
    state = stub(effects=(effect,), step_of=lambda prefix: step if prefix == effect.prefix else None)
    judged = stub(left=lambda effects: (0.5, 1.0, "run 2") if effects else (1.0, times, "run 2"))
    found = _within_disturbances(stub(settings=DiagnosisSettings()), state, judged)
    assert found == (effect.prefix if taken_back else None)
