"""What is offered to join a hypothesis."""

from __future__ import annotations

from greybox_torch.diagnosis.select.offered import from_motion


def test_the_measured_motion_is_not_asked_beside_a_free_curve(stub) -> None:
    """Seen: 74 s for the heights of one curve, which the equations would have had to estimate anew."""
    assert from_motion(stub(), stub(has_curve=True)) == []
