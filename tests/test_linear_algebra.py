"""Dense solves answer as numpy does where that answers, and with something finite where it does not."""

from __future__ import annotations

import threading

import numpy as np
import pytest
import torch
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from threadpoolctl import threadpool_info, threadpool_limits

from greybox_torch.linear_algebra import (
    HARDLY,
    cholesky,
    eigh,
    least_squares,
    lengths,
    on_one_thread,
    pseudo_inverse,
    solve,
)

MATRIX = np.array([[4.0, 1.0], [1.0, 3.0]])
RIGHT = np.array([1.0, 2.0])
ANY = st.floats(allow_nan=True, allow_infinity=True, width=64)


def test_sound_problems_are_solved_as_by_numpy_to_the_last_digit() -> None:
    np.testing.assert_array_equal(solve(MATRIX, RIGHT), np.linalg.solve(MATRIX, RIGHT))
    stack, rights = np.stack([MATRIX, 2 * MATRIX]), np.ones((2, 2, 3))
    np.testing.assert_array_equal(solve(stack, rights), np.linalg.solve(stack, rights))
    np.testing.assert_array_equal(least_squares(MATRIX, RIGHT), np.linalg.lstsq(MATRIX, RIGHT, rcond=None)[0])
    np.testing.assert_array_equal(cholesky(MATRIX), np.linalg.cholesky(MATRIX))
    np.testing.assert_array_equal(eigh(MATRIX)[0], np.linalg.eigh(MATRIX)[0])


def test_what_a_singular_matrix_does_not_determine_does_not_move() -> None:
    singular = np.array([[2.0, 0.0], [0.0, 0.0]])
    np.testing.assert_allclose(solve(singular, np.array([4.0, 0.0])), [2.0, 0.0])
    np.testing.assert_allclose(solve(singular[None], np.array([[[4.0], [0.0]]])), [[[2.0], [0.0]]])


def test_a_matrix_that_is_not_definite_gets_a_factor_near_to_it() -> None:
    almost = np.array([[1.0, 1.0], [1.0, 1.0]]) - 1e-14 * np.eye(2)
    lower = cholesky(almost)
    np.testing.assert_allclose(lower @ lower.T, almost, atol=1e-6)


NOT_DEFINITE = np.array([[1.0, 2.0], [2.0, 1.0]])
NOT_FINITE = [np.array([[1.0, value], [value, 2.0]]) for value in (np.nan, np.inf)]


@pytest.mark.parametrize("other", [NOT_DEFINITE, *NOT_FINITE])
def test_a_matrix_beside_one_that_cannot_be_factored_has_its_own_factor(other: np.ndarray) -> None:
    """Seen: all of the stack changed by 5e-13, and factors of NaN."""
    both = cholesky(np.stack([MATRIX, other]))
    np.testing.assert_array_equal(both[0], np.linalg.cholesky(MATRIX))
    np.testing.assert_array_equal(both[1], cholesky(other))
    assert np.isfinite(both).all() and (np.diagonal(both[1]) > 0).all()


@pytest.mark.parametrize("hermitian", [False, True])
@pytest.mark.parametrize("other", [*NOT_FINITE, np.full((2, 2), 1e-320)])
def test_a_matrix_beside_one_without_a_pseudo_inverse_has_its_own(other: np.ndarray, hermitian: bool) -> None:
    """Seen: NaN in place of zeros, and zeros in place of the others' pseudo-inverses."""
    with np.errstate(all="ignore"):
        both = pseudo_inverse(np.stack([MATRIX, other]), hermitian=hermitian)
    np.testing.assert_array_equal(both[0], np.linalg.pinv(MATRIX, hermitian=hermitian))
    np.testing.assert_array_equal(both[1], np.zeros((2, 2)))


@example(np.full((3, 3), 1e-273), np.full(3, 1e40))
@given(arrays(float, (3, 3), elements=ANY), arrays(float, 3, elements=ANY))
def test_the_answer_is_finite_whatever_is_asked(matrix, right) -> None:
    with np.errstate(all="ignore"):
        assert np.isfinite(least_squares(np.clip(matrix, -1e100, 1e100), np.clip(right, -1e100, 1e100))).all()
        assert np.isfinite(cholesky(np.clip(matrix, -1e100, 1e100))).all()
        assert np.isfinite(pseudo_inverse(np.clip(matrix, -1e100, 1e100))).all()
        assert np.isfinite(solve(np.clip(matrix, -1e100, 1e100), np.clip(right, -1e100, 1e100))).all()


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_eigenvalues_of_a_matrix_that_is_not_finite(value) -> None:
    values, vectors = eigh(np.array([[1.0, value], [value, 2.0]]))
    assert np.isfinite(values).all() and np.isfinite(vectors).all()


def test_small_products_take_one_thread_and_leave_others_theirs() -> None:
    def threads() -> set[int]:
        return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}

    with threadpool_limits(limits=2, user_api="blas"):
        assert on_one_thread(threads)() == {1}
        assert threads() == {2}


def test_torch_takes_one_thread_within_and_has_its_own_back_afterwards() -> None:
    def failing() -> None:
        assert torch.get_num_threads() == 1
        raise ValueError("within")

    before = torch.get_num_threads()
    try:
        torch.set_num_threads(2)
        with pytest.raises(ValueError, match="within"):
            on_one_thread(failing)()
        assert torch.get_num_threads() == 2
    finally:
        torch.set_num_threads(before)


def test_of_two_diagnoses_in_two_threads_both_have_their_threads_back() -> None:
    """A thread begins with what another has set; it is not to keep the one thread of a diagnosis beside it."""
    begun, ended, before, seen = threading.Event(), threading.Event(), torch.get_num_threads(), []

    @on_one_thread
    def longer() -> None:
        begun.set()
        assert ended.wait(10.0)
        seen.append(torch.get_num_threads())

    def other() -> None:
        longer()
        seen.append(torch.get_num_threads())

    try:
        torch.set_num_threads(2)
        thread = threading.Thread(target=other)
        on_one_thread(lambda: (thread.start(), begun.wait(10.0)))()
        assert torch.get_num_threads() == 2
        ended.set()
        thread.join(10.0)
        assert seen == [1, 2]
    finally:
        ended.set()
        torch.set_num_threads(before)


def test_lengths_do_not_depend_on_units() -> None:
    """Every unknown by its own curvature, the cube of a small deflection too; of what is nothing a finite one."""
    units = np.array([1.0, 1e9, 1e-30, 1.0])
    curvatures, values = np.array([4.0, 100.0, 1.0, 0.0]), np.array([1.0, 0.0, 2.0, 0.0])
    own = lengths(curvatures, values)
    np.testing.assert_allclose(own[:3], [0.5, 0.1, 1.0])
    assert np.isfinite(own[3])
    np.testing.assert_allclose(lengths(curvatures / units**2, values * units)[:3], (own * units)[:3])


def test_what_hardly_matters_at_its_own_size_goes_no_farther_than_what_does() -> None:
    """A network's weight behind another that is nearly zero: along its own curvature it would go to 1e9."""
    assert lengths(np.array([1.0, 1e-18]), np.array([1.0, 0.5]))[1] == pytest.approx(0.5 / np.sqrt(HARDLY))
    assert lengths(np.array([1.0, 1e-18]), np.array([1.0, 0.0]))[1] == pytest.approx(1e9)
