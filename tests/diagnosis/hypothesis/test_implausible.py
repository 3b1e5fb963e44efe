"""Parameters that are orders of magnitude from the card's values speak against the model as it stands."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from greybox_torch.diagnosis.hypothesis.fit import hypothesis
from greybox_torch.diagnosis.hypothesis.implausible import MOST_DECADES, implausibility
from greybox_torch.diagnosis.settings import DiagnosisSettings

SETTINGS = DiagnosisSettings()


def judged(stub, card: dict[str, float], values: dict[str, float]) -> float:
    return implausibility(stub(values_by_name=card), stub(values_by_name=values), SETTINGS)


@given(ratio=st.floats(0.1, 10.0), sign=st.sampled_from([-1.0, 1.0]))
def test_within_a_factor_of_ten_every_value_is_as_good(stub, ratio, sign) -> None:
    assert judged(stub, {"k": sign * 12.0}, {"k": sign * 12.0 * ratio}) == pytest.approx(0.0, abs=1e-9)


@given(decades=st.floats(1.0, 8.0), down=st.booleans())
def test_beyond_that_by_the_square_of_the_decades_until_it_has_vanished(stub, decades, down) -> None:
    """No digit means anything of damping that a machine does not have."""
    values = {"k": 12.0 * 10 ** (-decades if down else decades), "law.c": 1e9}
    expected = SETTINGS.implausible_decade * min(decades - 1.0, MOST_DECADES) ** 2
    assert judged(stub, {"k": 12.0}, values) == pytest.approx(expected, abs=1e-9)


def test_a_law_of_its_own_and_a_parameter_that_begins_at_zero_are_not_asked(stub) -> None:
    assert judged(stub, {"d": 0.0}, {"d": 5.0, "law.c": 1e-9}) == 0.0
    assert judged(stub, {"d": 2.0}, {"d": 0.0}) == pytest.approx(SETTINGS.implausible_decade * MOST_DECADES**2)


def test_it_counts_in_the_score_of_a_fit(dead_zone_search) -> None:
    """The card's inertia is taken as a thousand times the machine's: three decades."""
    study = dead_zone_search.study
    name, value = next(iter(study.problem.values_by_name.items()))
    assert dead_zone_search.plain.implausible == 0.0
    far = study.problem.with_values(
        [1e3 * v if n == name else v for n, v in study.problem.values_by_name.items()], study.problem.initial
    )
    start = {**study.problem.values_by_name, name: value}
    fitted = hypothesis(far, (), study.surroundings, [start], options=study.options)
    assert fitted is not None
    ratio = abs(fitted.values()[name] / (1e3 * value))
    assert ratio < 0.01
    assert fitted.implausible > 0.0
    errors = fitted.score - fitted.implausible
    assert errors == pytest.approx(dead_zone_search.plain.score, abs=1e-3)
