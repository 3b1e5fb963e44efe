"""How the weights of rivals become the probabilities that are told."""

from __future__ import annotations

import pytest

from greybox_torch.diagnosis.beliefs import NO_BELIEFS, Beliefs
from greybox_torch.diagnosis.select import posterior
from greybox_torch.diagnosis.select.posterior import separated, shared, shares, told_of
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.actuator import InputDelay
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.sensor import OutputDelay, SensorLag

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


@pytest.mark.parametrize(("outputs", "weight"), [(1, 0.4), (2, 0.1)], ids=["one output", "two outputs"])
def test_a_rival_weighs_as_much_as_its_twin_by_the_share_of_its_gain(stub, monkeypatch, outputs, weight) -> None:
    """Seen: a lag of a servo's sensor, told beside a delay of its output (0.21) and none of its input, which is the same."""
    records = stub(u=[0], y=[0] * outputs)
    laws = (("sensor", SensorLag(), 1.0), ("sensor", OutputDelay(), 0.8), ("actuator", InputDelay(), 0.4))
    ranked = [
        stub(candidate=stub(attachment=Attachment(p, law)), fitted=stub(problem=stub(records=records)), gain=gain)
        for p, law, gain in laws
    ]
    weights = {id(ranked[1]): 0.8, id(ranked[2]): 0.1}
    monkeypatch.setattr(posterior, "_weight", lambda best, rival, settings: weights[id(rival)])
    found = {r.candidate.attachment.mechanism.name: p for r, p in shares(ranked[0], ranked, SETTINGS)}
    assert found["input_delay"] / found["output_delay"] == pytest.approx(weight / 0.8)
    excluded = shares(ranked[0], ranked, SETTINGS, Beliefs({"actuator/input_delay": 0.0}))
    assert min(p for _, p in excluded) == 0.0, "what is believed counts beside that"
