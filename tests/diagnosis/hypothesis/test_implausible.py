"""Parameters that are orders of magnitude from the card's values speak against the model as it stands."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from greybox_torch.diagnosis.hypothesis import fit
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


def fitted_with(search, far: float):
    """The model as it stands, fitted from the card's values, where the card's first parameter is taken as so many times as large."""
    study = search.study
    name, value = next(iter(study.problem.values_by_name.items()))
    values = study.problem.values.copy()
    values[list(study.problem.names).index(name)] = far * value
    card = study.problem.with_values(values, study.problem.initial)
    found = hypothesis(card, (), study.surroundings, [study.problem.values_by_name], options=study.options)
    assert found is not None
    return found


@pytest.mark.parametrize("times_noise", [2.0, 4.0])
def test_it_counts_in_the_score_where_little_more_than_noise_is_left(
    monkeypatch, dead_zone_search, times_noise
) -> None:
    """A parameter of the card is taken as a thousand times the machine's: three decades, of which the first does not count."""
    monkeypatch.setattr(fit, "reaches_noise", lambda base, one, settings, most=1.0: times_noise <= most)
    near, far = fitted_with(dead_zone_search, 1.0), fitted_with(dead_zone_search, 1e3)
    assert near.implausible == 0.0
    assert far.score - far.implausible == pytest.approx(near.score, abs=1e-3)
    name, value = next(iter(dead_zone_search.study.problem.values_by_name.items()))
    beyond = 2.0 - np.log10(far.values()[name] / value)
    assert beyond > 1.0
    told = times_noise < SETTINGS.far_above_noise
    assert far.implausible == pytest.approx(SETTINGS.implausible_decade * beyond**2 if told else 0.0)
