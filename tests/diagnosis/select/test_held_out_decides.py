"""A law that removes most of the error is taken though windows leave it open, and held-out experiments decide."""

from __future__ import annotations

import pytest

from greybox_torch.diagnosis.confirm import take_back
from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.select import forward_step
from greybox_torch.diagnosis.settings import DiagnosisSettings


@pytest.mark.parametrize(("significance", "taken_back"), [(2.4, "arm.gravity"), (3.1, None)])
def test_what_windows_left_open_is_taken_back_where_held_out_experiments_do_not_exercise_it(
    stub, monkeypatch, significance, taken_back
) -> None:
    monkeypatch.setattr(take_back, "_idle", lambda *given: None)
    monkeypatch.setattr(take_back, "sharing_with_the_rest", lambda *given: None)
    settings = DiagnosisSettings()
    taken = stub(removed=0.89, significance=significance, unknown=False)
    state = stub(step_of=lambda prefix: stub(taken=taken), current=None)
    others = stub(study=stub(settings=settings), fits=lambda hypothesis: ())
    unexercised = Gain(0.0, 0.1, untouched=True)
    assert unexercised.unexercised(settings) and unexercised.errors_away < settings.least_held_out
    assert take_back._to_take_back(stub(), state, {"arm.gravity": unexercised}, others) == taken_back


@pytest.mark.parametrize(
    ("removed", "significance", "curve", "taken"),
    [
        (0.89, 2.4, False, True),
        (0.89, 1.9, False, False),
        (0.70, 2.4, False, False),
        (0.89, 2.4, True, False),
        (0.10, 3.1, True, True),
    ],
)
def test_what_windows_of_very_different_energy_leave_open(stub, removed, significance, curve, taken) -> None:
    """Seen: the weight of an arm that a propeller lifts, which is at rest in most windows: 89 % of the error, 2.4 standard errors."""
    ranked = stub(removed=removed, gain=0.0, significance=significance, unknown=curve)
    assert forward_step._sure(lambda: 0.0, ranked, DiagnosisSettings()) is taken
