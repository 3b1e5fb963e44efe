"""What a finding claims of each answer, and what that scores."""

from __future__ import annotations

import pytest

from experiments.verdicts.answers import claims, half_brier, hypotheses

TWINS = {
    "port": "actuator",
    "mechanism": "input_bias",
    "probability": 0.48,
    "alternatives": [
        {"port": "body", "mechanism": "constant_bias", "probability": 0.46},
        {"port": "body", "mechanism": "gravity", "probability": 0.03},
    ],
    "one_of": {"members": [{"port": "body", "mechanism": "constant_bias", "probability": 0.46}]},
}
EITHER = {("actuator", "input_bias"), ("body", "constant_bias")}


def test_names_that_the_key_accepts_are_one_answer() -> None:
    assert sum(hypotheses(TWINS).values()) == pytest.approx(0.97)  # a member that is an alternative too counts once
    said = claims(TWINS, EITHER)
    assert said == ((pytest.approx(0.94), True), (0.03, False))
    assert half_brier(said) == pytest.approx(0.5 * (0.06**2 + 0.03**2 + 0.03**2))


def test_a_wrong_name_pays_for_all_that_it_claims() -> None:
    """Two that share one probability between them cost less than one that has it all, and neither costs as little as a right answer."""
    sure = half_brier([(0.97, False)])
    assert sure == pytest.approx(0.97**2)
    assert half_brier(claims(TWINS, ())) == pytest.approx(0.5 * (0.48**2 + 0.46**2 + 0.03**2 + 0.97**2))
    assert half_brier(claims(TWINS, EITHER)) < half_brier(claims(TWINS, ())) < sure


def test_of_two_answers_it_is_the_usual_square() -> None:
    for p in (0.0, 0.3, 0.9):
        assert half_brier([(p, True), (1.0 - p, False)]) == pytest.approx((1.0 - p) ** 2)


def test_the_right_one_among_the_alternatives_counts() -> None:
    said = claims(TWINS, {("body", "gravity")})
    assert said[0] == (0.03, True) and sorted(said[1:]) == [(0.46, False), (0.48, False)]
    assert half_brier(said) < half_brier(claims(TWINS, ())) + 1e-12
