"""Dense linear algebra that always answers: where LAPACK gives up, the answer is that of the nearest problem that it solves.

A drive at exact standstill, a channel that does not move or a window whose simulation overflows make matrices that are singular or not
finite. None of these is a reason to end a search: what cannot be determined moves by nothing.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial, wraps
from typing import ParamSpec, TypeVar

import numpy as np
import torch
from threadpoolctl import threadpool_limits

Arguments = ParamSpec("Arguments")
Returned = TypeVar("Returned")

RIDGE = 1e-12
"""Share of the largest diagonal entry that is added where a matrix cannot be factored."""

HARDLY, NOTHING = 1e-14, 1e-200
"""Shares of the largest contribution to a residual, squared, and of the largest curvature."""

_torch = threading.Lock()
_within: list[int] = []
"""How many threads torch had before the functions that are under way, in this and other threads: those before the first."""


@contextmanager
def _torch_on_one_thread() -> Iterator[None]:
    """Within, torch computes on the thread that calls it; afterwards on as many as before the first of the blocks under way."""
    with _torch:
        here = torch.get_num_threads()  # asked in any case: a thread takes what another has set when it asks first
        before = _within[0] if _within else here
        _within.append(before)
        torch.set_num_threads(1)
    try:
        yield
    finally:
        with _torch:
            _within.pop()
            torch.set_num_threads(before)


def on_one_thread(function: Callable[Arguments, Returned]) -> Callable[Arguments, Returned]:
    """The function, within which BLAS, LAPACK and torch compute on the thread that calls them.

    The arrays here are small, and work is shared out in larger pieces (:mod:`greybox_torch.simulation.side_by_side`). Libraries with
    threads of their own have them wait for one another, and for whatever else the machine does: beside other programs a product of 1 ms
    then takes 600 ms, and a hyperbolic tangent of a whole record 5 ms instead of 0.1 ms.
    """

    @wraps(function)
    def limited(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Returned:
        with _torch_on_one_thread(), threadpool_limits(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return limited


def solve(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """The solution of M x = r, for one matrix (n, n) or a stack of them (…, n, n), as :func:`numpy.linalg.solve`.

    Of a singular matrix, the solution of smallest norm in the sense of least squares; entries that are not finite count as zero.
    """
    try:
        found = np.linalg.solve(matrix, right)
        if np.isfinite(found).all():
            return found
    except np.linalg.LinAlgError:
        pass
    sound = np.nan_to_num(matrix, posinf=0.0, neginf=0.0)
    vector = right.ndim == matrix.ndim - 1
    target = np.nan_to_num(right[..., None] if vector else right, posinf=0.0, neginf=0.0)
    with np.errstate(over="ignore", invalid="ignore"):
        found = np.nan_to_num(pseudo_inverse(sound) @ target, posinf=0.0, neginf=0.0)
    return found[..., 0] if vector else found


def least_squares(columns: np.ndarray, target: np.ndarray, rcond: float | None = None) -> np.ndarray:
    """The x of smallest norm that minimises ‖A x − b‖, as the first result of :func:`numpy.linalg.lstsq`; zeros for what is not finite."""
    try:
        # With what is not a number LAPACK may iterate for ever.
        if np.isfinite(columns).all() and np.isfinite(target).all():
            found = np.linalg.lstsq(columns, target, rcond=rcond)[0]
            if np.isfinite(found).all():
                return found
    except np.linalg.LinAlgError:
        pass
    sound, wanted = (np.nan_to_num(a, posinf=0.0, neginf=0.0) for a in (columns, target))
    scale = max(float(np.abs(sound).max(initial=0.0)), 1e-300)
    sound = sound / scale  # its square overflows later
    found = solve(sound.T @ sound + _ridge(sound.T @ sound), sound.T @ wanted) / scale
    return np.nan_to_num(found, posinf=0.0, neginf=0.0)  # tiny columns and a large target: beyond the largest number


def lengths(curvatures: np.ndarray, sizes: np.ndarray | None = None) -> np.ndarray:
    """The changes (..., d) by which unknowns move a residual by one, from their ``curvatures`` (..., d), the diagonal of JᵀJ.

    Each by itself, whatever the others are: an inertia in kg m², a pressure in Pa and a coefficient of (1e-6 m)³ are fifty orders of
    magnitude apart. What hardly matters at its own size (a share ``HARDLY`` of what the unknown that matters most does at its own) is no
    longer than as if it did that much.

    Args:
        sizes: of the unknowns (..., d), where they are known: zero for those of which none is.

    Source: J. J. Moré, "The Levenberg-Marquardt algorithm: implementation and theory", 1978: steps that do not depend on units.
    """
    squares = np.square(np.zeros_like(curvatures) if sizes is None else sizes)
    most = HARDLY * (curvatures * squares).max(axis=-1, keepdims=True, initial=0.0)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        floor = np.where(squares > 0, most / squares, 0.0)
    nothing = NOTHING * np.maximum(curvatures.max(axis=-1, keepdims=True, initial=0.0), 1e-100)
    return 1.0 / np.sqrt(np.maximum(curvatures, np.maximum(np.nan_to_num(floor, posinf=0.0), nothing)))


def eigh(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues, ascending, and eigenvectors of a symmetric matrix (n, n), as :func:`numpy.linalg.eigh`."""
    try:
        values, vectors = np.linalg.eigh(matrix)
        if np.isfinite(values).all():
            return values, vectors
    except np.linalg.LinAlgError:
        pass
    sound = np.nan_to_num(matrix, posinf=0.0, neginf=0.0)
    values, vectors = np.linalg.eigh(0.5 * (sound + sound.T) + _ridge(sound))
    return values, vectors


def eigenvalues(matrix: np.ndarray) -> np.ndarray:
    """Eigenvalues of a symmetric matrix (n, n), ascending, as :func:`numpy.linalg.eigvalsh`."""
    try:
        values = np.linalg.eigvalsh(matrix)
        if np.isfinite(values).all():
            return values
    except np.linalg.LinAlgError:
        pass
    return eigh(matrix)[0]


def cholesky(matrix: np.ndarray) -> np.ndarray:
    """The lower factor of positive definite matrices (…, n, n). Of one that is not, the factor of the nearest that is, with a ridge; there,
    entries that are not finite count as zero.
    """
    return _one_by_one(np.linalg.cholesky, _lifted_factor, matrix)


def _lifted_factor(matrix: np.ndarray) -> np.ndarray:
    """The lower factor of the positive definite matrix nearest to one (n, n), and of a ridge."""
    sound = np.nan_to_num(matrix, posinf=0.0, neginf=0.0)
    values, vectors = np.linalg.eigh(0.5 * sound + 0.5 * sound.T)
    least = max(RIDGE * values[-1], 1e-300)
    lifted = (vectors * np.maximum(values, least)) @ vectors.T
    return np.linalg.cholesky(lifted + _ridge(lifted))


def pseudo_inverse(matrix: np.ndarray, rcond: float = RIDGE, *, hermitian: bool = False) -> np.ndarray:
    """The pseudo-inverse of (…, m, n), as :func:`numpy.linalg.pinv`; zeros where there is none that is finite."""
    return _one_by_one(
        partial(np.linalg.pinv, rcond=rcond, hermitian=hermitian), lambda one: np.zeros(one.T.shape), matrix
    )


def _one_by_one(
    function: Callable[[np.ndarray], np.ndarray], instead: Callable[[np.ndarray], np.ndarray], stack: np.ndarray
) -> np.ndarray:
    """``function`` of a stack of matrices (…, m, n), and ``instead`` of those of them for which it fails or is not finite."""
    try:
        found = function(stack)
        if np.isfinite(found).all():
            return found
    except np.linalg.LinAlgError:
        pass
    if stack.ndim == 2:
        return instead(stack)
    return np.stack([_one_by_one(function, instead, one) for one in stack])


def _ridge(matrix: np.ndarray) -> np.ndarray:
    """A multiple of the identity that is small beside the largest diagonal entry."""
    largest = np.abs(np.diagonal(matrix, axis1=-2, axis2=-1)).max(axis=-1, initial=0.0)
    return (RIDGE * largest + 1e-300)[..., None, None] * np.eye(matrix.shape[-1])
