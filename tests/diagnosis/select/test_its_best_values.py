"""A law stands with its best values, not with the best of those that say something of the machine."""

from __future__ import annotations

import pytest

from greybox_torch.diagnosis.select import its_best_values as module
from greybox_torch.diagnosis.select.its_best_values import tellable, with_values_that_say_something
from greybox_torch.diagnosis.settings import DiagnosisSettings

SETTINGS = DiagnosisSettings()
TIE = SETTINGS.score_tie


@pytest.fixture
def refit(stub):
    """A refit of a law at a port; ``says``: whether its values say something of the machine."""

    def make(score: float, says: bool, law: str = "torque_ripple", size: int = 7, unknown: bool = False):
        named = ("pivot", law)
        return stub(
            candidate=stub(attachment=stub(named=named)),
            fitted=stub(score=score),
            says=says,
            size=size,
            unknown=unknown,
        )

    return make


@pytest.fixture
def asked(monkeypatch, stub):
    """What is left of refits, where a difference is so many standard errors away from chance."""

    def make(*refits, errors: float = 9.0, complete: bool = True):
        monkeypatch.setattr(module, "completes", lambda fitted, settings: complete)
        monkeypatch.setattr(module, "sound", lambda study, ranked: ranked.says)
        monkeypatch.setattr(module, "window_significance", lambda before, after, settings: errors)
        return tellable(stub(settings=SETTINGS), refits)

    return make


def test_a_law_that_goes_farther_with_values_that_say_nothing_is_refuted(asked, refit) -> None:
    """Seen: a notch, told as a ripple of six waves that repeats 2.1 times; six that repeat 1.3 times left noise alone."""
    ripple, drag = refit(0.06, True), refit(0.5, True, law="quadratic_drag")
    assert asked(refit(-0.03, False), ripple, drag) == [drag]


@pytest.mark.parametrize(
    "other",
    [
        {"score": 0.06 - 0.5 * TIE},
        {"score": 0.2},
        {"score": -0.03, "law": "unknown"},
        {"score": -0.03, "size": 13},
    ],
    ids=["a tie", "no farther", "another law", "more parameters"],
)
def test_else_it_stands(asked, refit, other) -> None:
    ripple = refit(0.06, True)
    assert asked(refit(says=False, **other), ripple) == [ripple]


def test_chance_refutes_nothing(asked, refit) -> None:
    ripple = refit(0.06, True)
    assert asked(refit(-0.03, False), ripple, errors=0.5 * SETTINGS.least_significance) == [ripple]


def test_where_more_than_noise_is_left_nothing_is_refuted(asked, refit) -> None:
    """Seen: a rail with a dip and a bump, of which no ripple leaves noise alone."""
    ripple = refit(0.06, True)
    assert asked(refit(-0.03, False), ripple, complete=False) == [ripple]


def test_a_free_curve_says_nothing_of_its_values_and_stands(asked, refit) -> None:
    curve = refit(0.06, True, unknown=True)
    assert asked(refit(-0.03, False), curve) == [curve]


def test_a_law_in_the_place_of_a_curve_keeps_values_that_say_something(refit, stub, monkeypatch) -> None:
    """Seen: a drive's limit, led to the end of what it may be beside a drag that was missing as well."""
    monkeypatch.setattr(module, "sound", lambda study, ranked: ranked.says)
    monkeypatch.setattr(module, "in_order", lambda ranked, settings: list(ranked))
    monkeypatch.setattr(module, "judged", lambda candidate, parent, fitted, settings: (candidate, parent, fitted.score))
    study, limit, lag = stub(settings=SETTINGS), refit(0.4, True), refit(0.5, True)
    led_away = stub(**{**vars(limit), "says": False, "fitted": stub(score=0.3)})
    better = stub(**{**vars(lag), "fitted": stub(score=0.35)})
    never = stub(**{**vars(refit(0.2, False))})
    kept = with_values_that_say_something(study, "parent", [led_away, better], [limit, lag])  # pyright: ignore
    assert kept == ((limit.candidate, "parent", 0.4), better)
    assert with_values_that_say_something(study, "parent", [never, better], [never, lag]) == (never, better)  # pyright: ignore
