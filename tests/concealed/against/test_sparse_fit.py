"""Terms are found back from a force that is made of them; noise is not made of terms."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from experiments.concealed.against.sparse_fit import named, regress
from experiments.concealed.against.terms import Term

pytest.importorskip("pysindy", reason="pysindy is not installed (extra [proof])")

LIBRARY = (
    Term("v", ("speed",), lambda s: s.speed, "viscous_friction", "viscous_friction"),
    Term("v |v|", ("speed",), lambda s: s.speed * abs(s.speed), "quadratic_drag", "quadratic_drag"),
    Term("1", ("speed",), lambda s: 1.0, "", ""),
    Term("tanh", ("speed",), lambda s: s.speed, "nonlinear_stiffness", "backlash"),
)
SPLIT = 1400
NOTHING = np.zeros((2000, 0))


def table(seed: int) -> np.ndarray:
    v = 3.0 * np.random.default_rng(seed).standard_normal(2000)
    return np.stack([v, v * abs(v), np.ones_like(v), np.tanh(v)], axis=1)


@given(st.integers(0, 50), st.floats(0.5, 5.0), st.sampled_from([-1.0, 1.0]))
def test_a_planted_term_is_found_with_its_coefficient(seed: int, size: float, sign: float) -> None:
    columns = table(seed)
    noise = 0.02 * size * np.random.default_rng(seed + 1).standard_normal(len(columns))
    found = list(regress("rotor", LIBRARY, columns, NOTHING, sign * size * columns[:, 1] + 40.0 + noise, SPLIT))
    sparsest = min(found, key=lambda s: len(s.terms))
    assert [t.name for t in sparsest.terms] == ["v |v|"]  # and the constant, which speaks for nothing, is projected out
    assert sparsest.coefficients[0] == pytest.approx(sign * size, rel=0.02)
    assert sparsest.predicted > 0.99
    assert named(sparsest.terms, sparsest.coefficients, sparsest.gram) == ("quadratic_drag",)


def test_noise_is_not_predicted() -> None:
    force = np.random.default_rng(3).standard_normal(2000)
    assert all(s.predicted < 0.05 for s in regress("rotor", LIBRARY, table(4), NOTHING, force, SPLIT))


@pytest.mark.parametrize("force", [np.zeros(2000), np.full(2000, np.nan)])
def test_no_force_and_a_force_that_is_no_number_give_no_fit(force: np.ndarray) -> None:
    assert list(regress("rotor", LIBRARY, table(5), NOTHING, force, SPLIT)) == []


def test_mechanisms_are_named_by_what_their_terms_carry_together() -> None:
    gram = np.diag([1.0, 1.0, 1.0])
    chosen = (LIBRARY[0], LIBRARY[1], LIBRARY[3])
    assert named(chosen, np.array([0.1, 1.0, -0.8]), gram) == ("quadratic_drag", "backlash")


def test_what_the_model_can_do_already_is_no_finding() -> None:
    columns = table(6)
    noise = 0.05 * np.random.default_rng(7).standard_normal(2000)
    force = 3.0 * columns[:, 0] - 0.5 * columns[:, 1] + noise
    found = list(regress("rotor", LIBRARY, columns, columns[:, :1], force, SPLIT))
    assert found
    assert all("v" not in [t.name for t in s.terms] for s in found)
    sparsest = min(found, key=lambda s: len(s.terms))
    assert [t.name for t in sparsest.terms] == ["v |v|"]
    assert sparsest.coefficients[0] == pytest.approx(-0.5, rel=0.02)


def test_a_constant_force_is_found_where_it_speaks_for_something() -> None:
    bias = Term("1", ("speed",), lambda s: 1.0, "constant_bias", "constant_bias")
    library = (*LIBRARY[:2], bias, LIBRARY[3])
    noise = 0.05 * np.random.default_rng(9).standard_normal(2000)
    sparsest = min(regress("rotor", library, table(8), NOTHING, 0.3 + noise, SPLIT), key=lambda s: len(s.terms))
    assert [t.name for t in sparsest.terms] == ["1"]
    assert sparsest.predicted > 0.9
