"""Which candidate is told where nothing is found: one that would explain most of it, and is not sure."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.describe.unsure import unsure_candidate
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.settings import DiagnosisSettings
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
