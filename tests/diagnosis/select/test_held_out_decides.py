"""A law that removes most of the error is taken though windows leave it open, and held-out experiments decide."""

from __future__ import annotations

import math

import pytest

from greybox_torch.diagnosis.select import forward_step
from greybox_torch.diagnosis.settings import DiagnosisSettings


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
    ranked = stub(of_errors=-math.log1p(-removed), gain=0.0, significance=significance, unknown=curve)
    assert forward_step._sure(lambda: 0.0, ranked, DiagnosisSettings()) is taken
