"""What the likelihood of whole records says where windows are too few."""

from __future__ import annotations

import pytest

from greybox_torch.diagnosis.refit import likelihood
from greybox_torch.diagnosis.refit.likelihood import likelier, needed_by_likelihood
from greybox_torch.diagnosis.settings import DiagnosisSettings

SETTINGS = DiagnosisSettings(least_gain_by_likelihood=0.05, least_likelihood_significance=10.0)


@pytest.mark.parametrize(
    ("case", "taken"),
    [
        ({}, True),
        ({"cost": 151.0}, False),  # 9.9 standard errors
        ({"gain": 0.04}, False),
        ({"samples": 0}, False),  # more than white noise is left
        ({"unknown": True}, False),
    ],
)
def test_it_speaks_only_for_a_law_that_leaves_noise_alone_and_gains_enough(monkeypatch, stub, case, taken) -> None:
    """Seen: viscous friction of a hanging pole, which ten long windows showed with 2.6 standard errors and the record with 20."""
    known = {"cost": 149.0, "gain": 0.4, "samples": 5000, "unknown": False} | case
    monkeypatch.setattr(likelihood, "cost_of", lambda fitted: {"after": known["cost"]}[fitted])
    monkeypatch.setattr(likelihood, "white_samples", lambda fitted, settings: known["samples"])
    ranked = stub(unknown=known["unknown"], gain=known["gain"], fitted="after", cost=None)
    assert likelier(lambda: 200.0, ranked, SETTINGS) is taken  # type: ignore[arg-type]
    known_before = stub(unknown=known["unknown"], gain=known["gain"], fitted=None, cost=known["cost"])
    assert likelier(lambda: 200.0, known_before, SETTINGS) is taken, "a cost that is known is not computed again"


@pytest.mark.parametrize(
    ("without", "gain", "samples", "needed"),
    [(200.0, 0.9, 5000, True), (198.0, 0.9, 5000, False), (200.0, 0.04, 5000, False), (200.0, 0.9, 0, False)],
)
def test_an_effect_is_needed_by_the_measure_that_it_was_taken_by(
    monkeypatch, stub, without, gain, samples, needed
) -> None:
    fewer, whole = stub(score=gain, cost=without), stub(score=0.0, cost=149.0)
    monkeypatch.setattr(likelihood, "cost_of", lambda fitted: fitted.cost)
    monkeypatch.setattr(likelihood, "white_samples", lambda fitted, settings: samples)
    assert needed_by_likelihood(fewer, whole, SETTINGS) is needed
