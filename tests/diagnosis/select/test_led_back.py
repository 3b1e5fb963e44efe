"""A search that choosing once more leads back to what there was does not choose once more again."""

from __future__ import annotations

from typing import Any

import pytest

from greybox_torch.diagnosis.select import search as module
from greybox_torch.diagnosis.select.search import search
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.friction import CoulombFriction, QuadraticDrag, ViscousFriction

DRY, DRAG, VISCOUS = (Attachment("rotor", law()) for law in (CoulombFriction, QuadraticDrag, ViscousFriction))


@pytest.mark.parametrize(
    ("ends", "revisions"), [([DRAG, DRAG], 1), ([VISCOUS, DRAG], 2)], ids=["led back", "elsewhere, then back"]
)
def test_what_is_led_back_is_not_chosen_again(monkeypatch, stub, ends, revisions) -> None:
    """Seen: a heated block's leak, taken and dropped beside a threshold three times over: half of the search's 34 s."""
    asked, to_come = [], list(ends)

    def there(effect: Attachment) -> Any:
        return stub(effects=(effect,), current=object())

    def stage(of: Any) -> Any:
        def run(study: Any, state: Any) -> Any:
            yield state
            return of(state)

        return run

    def chosen_once_more(state: Any) -> Any:
        asked.append(state.effects)
        return there(DRY)

    monkeypatch.setattr(module, "explore", stage(lambda state: there(DRAG)))
    monkeypatch.setattr(module, "revise", stage(chosen_once_more))
    monkeypatch.setattr(module, "take_effects", stage(lambda state: there(to_come.pop(0))))
    for name in ("drop_superfluous", "with_memory", "without_idle_bumps"):
        monkeypatch.setattr(module, name, stage(lambda state: state))
    found = result_of(search(stub(budget=SearchBudget(), settings=DiagnosisSettings()), there(DRY)))
    assert len(asked) == revisions
    assert found.effects == (ends[revisions - 1],)
