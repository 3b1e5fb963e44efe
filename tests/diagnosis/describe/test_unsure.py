"""Which candidate is told where nothing is found: one that would explain most of it, and is not sure."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.describe import unsure as module
from greybox_torch.diagnosis.describe.unsure import best_further, unsure_candidate
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.actuator import InputLag
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombFriction


@pytest.fixture
def told(stub):
    def make(*candidates, taken=False, effects=(), windows=20):
        """The clause for candidates (law, share removed, standard errors) of one step."""
        plain, fits = stub(effects=effects), (stub(energies=np.ones(windows)),)
        ranked = tuple(
            stub(
                candidate=stub(attachment=Attachment("arm", law)),
                removed=share,
                significance=errors,
                fitted=stub(fits=fits),
            )
            for law, share, errors in candidates
        )
        step = SelectionStep((), plain, ranked, ranked[0] if taken else None)
        return unsure_candidate(SearchState(plain, plain, (step,)), DiagnosisSettings())

    return make


def test_the_one_that_removes_most(told) -> None:
    assert told((ConstantBias(), 0.6, 1.0), (CoulombFriction(), 0.89, 2.4)) == (
        "Coulomb friction at arm would lower its mean square by 89 %, but by only 2.4 times its standard error, where 3 are required; more "
        "windows or longer records would tell"
    )


def test_what_removes_little_or_is_sure_or_was_taken_or_stands_beside_others_is_not_told(told) -> None:
    assert told((CoulombFriction(), 0.03, 2.0)) == ""
    assert told((CoulombFriction(), 0.89, 4.0)) == "", "it was left out for another reason, which the evidence has"
    assert told((CoulombFriction(), 0.89, 2.4), taken=True) == ""
    assert told((CoulombFriction(), 0.89, 2.4), effects=(Attachment("arm", ConstantBias()),)) == ""
    assert told() == ""


def test_too_few_windows(told) -> None:
    assert "but there are too few windows to be sure;" in told((CoulombFriction(), 0.89, 0.0), windows=2)


@pytest.fixture
def further(stub, monkeypatch: pytest.MonkeyPatch):
    def make(removed: float, errors: float, *, taken=False, little=True, beside="arm.constant_bias"):
        """The clause for one candidate of a step, where ``beside`` was found before it."""
        monkeypatch.setattr(module, "leaves_little", lambda *_: little)
        parent = stub(effects=(stub(prefix=beside),))
        best = stub(candidate=stub(attachment=Attachment("motor", InputLag())), removed=removed, significance=errors)
        step = SelectionStep((), parent, (best,), best if taken else None)
        current = stub(effects=(Attachment("arm", ConstantBias()),))
        return best_further(stub(settings=DiagnosisSettings()), SearchState(stub(), current, (step,)))

    return make


def test_the_best_beside_what_was_found(further) -> None:
    """Seen: a lag that would lower the error by 51 % (16.5 standard errors), and "look … for what is not recorded, such as a load"."""
    told = "input lag at motor would take up 51 % of it over windows (16.5 standard errors), and was not taken"
    assert further(0.51, 16.5, little=False) == told
    assert further(0.51, 16.5).startswith(
        f"{told}: less than 2 % of the mismatch was left, and there a further effect is"
    )


def test_not_what_takes_up_little_or_is_not_sure_or_stands_beside_others(further) -> None:
    assert further(0.1, 16.5) == further(0.51, 2.0) == further(0.51, 16.5, taken=True) == ""
    assert further(0.51, 16.5, beside="arm.coulomb_friction") == ""
