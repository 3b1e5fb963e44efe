"""How the weights of rivals become the probabilities that are told."""

from __future__ import annotations

import pytest

from greybox_torch.diagnosis.beliefs import NO_BELIEFS, Beliefs
from greybox_torch.diagnosis.select import posterior
from greybox_torch.diagnosis.select.posterior import separated, shared, shares, told_of
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombFriction

SETTINGS = DiagnosisSettings()
BELIEFS = Beliefs({"rotor/coulomb_friction": 0.8})


@pytest.fixture
def rivals(stub, monkeypatch):
    """A finding and one rival that the recordings give a weight beside it."""

    def make(weight: float):
        best, behind = (
            stub(candidate=stub(attachment=Attachment("rotor", law))) for law in (ConstantBias(), CoulombFriction())
        )
        monkeypatch.setattr(posterior, "_weight", lambda *given: weight)
        return best, [best, behind]

    return make


@pytest.mark.parametrize(("beliefs", "odds"), [(NO_BELIEFS, 1.0), (BELIEFS, 4.0)])
def test_what_leads_is_told_with_more_than_its_weight(rivals, beliefs, odds) -> None:
    """Names told with 0.3 to 0.5 came true in four of five: what recordings say is told to a power, what is believed is not."""
    best, ranked = rivals(0.4)
    ((_, weighed),) = shares(best, ranked, SETTINGS, beliefs)
    assert weighed / (SETTINGS.highest_probability - weighed) == pytest.approx(odds * 0.4)
    own, (told,) = shared(best, ranked, SETTINGS, beliefs)
    assert told.probability / own == pytest.approx(odds * 0.4**SETTINGS.share_exponent, rel=1e-2)
    assert own + told.probability == pytest.approx(SETTINGS.highest_probability, abs=1e-3)
    assert told_of(best, ranked, SETTINGS, beliefs) == {
        ("rotor", "coulomb_friction"): pytest.approx(told.probability, abs=1e-4)
    }


def test_equal_rivals_stay_equal(rivals) -> None:
    best, ranked = rivals(1.0)
    own, (told,) = shared(best, ranked, SETTINGS)
    assert own == told.probability == pytest.approx(SETTINGS.highest_probability / 2)


def test_the_search_excludes_with_more_care_than_is_told(rivals) -> None:
    best, ranked = rivals(0.1)
    assert shared(best, ranked, SETTINGS)[0] > SETTINGS.beyond_doubt
    assert not separated(best, ranked, SETTINGS)
    assert separated(*rivals(0.01), SETTINGS)
