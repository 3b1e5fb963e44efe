"""What an effect has to remove where nobody knows how much of the error is noise."""

from __future__ import annotations

import pytest

from greybox_torch.diagnosis.select import forward_step
from greybox_torch.diagnosis.settings import DiagnosisSettings


@pytest.mark.parametrize(("removed", "noise"), [(0.1, True), (0.26, False)])
def test_a_law_has_to_remove_a_fifth(stub, monkeypatch, removed, noise) -> None:
    """Seen: a complete preheater, of whose error a constant removed a tenth; and a screw drive's Stribeck friction, which removes 26 %."""
    monkeypatch.setattr(forward_step, "far_above_noise", lambda fitted, settings: False)
    known = False
    monkeypatch.setattr(forward_step, "floor_known", lambda problem, settings: known)

    def with_error(square: float):
        return stub(fits=(stub(mean_square=square),), problem=None)

    study = stub(settings=DiagnosisSettings())
    before, taken = with_error(1.0), stub(fitted=with_error(1.0 - removed))
    state = stub(plain=before, current=before, effects=())
    assert forward_step._may_be_noise(study, state, taken) is noise
    beside = stub(plain=before, current=before, effects=("another",))
    assert not forward_step._may_be_noise(study, beside, taken)
    known = True
    assert not forward_step._may_be_noise(study, state, taken)
