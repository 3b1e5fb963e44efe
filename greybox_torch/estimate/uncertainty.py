"""Standard deviations of estimates."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.information import FLAT_BY_SAMPLES
from greybox_torch.linear_algebra import eigh

FLAT = 1e-12
"""Curvature, relative to the largest in unknowns of unit diagonal, that rounding alone accounts for."""


@dataclass(frozen=True)
class Uncertainty:
    """Covariances (d, d) of the unknowns z.

    ``plain`` is σ² (JᵀJ)⁻¹, right where the residuals are white. ``sandwich`` replaces its middle by the scatter of the score over
    stretches of the record, neighbouring ones together as far as they are correlated: right where the residuals are coloured, as they
    are whenever physics is missing. ``undetermined`` lists the indices of unknowns that the data do not determine; their standard
    deviation is infinite.
    """

    plain: np.ndarray
    sandwich: np.ndarray
    undetermined: tuple[int, ...]

    def deviations(self, kind: str = "plain") -> np.ndarray:
        """Standard deviations (d,) of ``kind`` "plain" or "sandwich"."""
        result = np.sqrt(np.maximum(np.diag(getattr(self, kind)), 0.0))
        result[list(self.undetermined)] = np.inf
        return result


def uncertainty(run: FreeRun, z: np.ndarray, penalty: np.ndarray | None = None) -> Uncertainty:
    """Covariance of the estimates at the optimum ``z`` (d,).

    Args:
        penalty: half the second derivative (d,) of what was added to the sum of squares, where something was: an unknown that the data
            leave open then varies as far as the penalty lets it.

    Source: L. Ljung, "System Identification: Theory for the User", 2nd ed., ch. 9; R. M. Bell and D. F. McCaffrey, "Bias reduction in
    standard errors for linear regression with multi-stage samples", 2002 (leverage of a stretch); W. K. Newey and K. D. West, 1987, and
    D. W. K. Andrews, 1991 (correlation between stretches and how far it reaches).
    """
    normals = run.normals(z)
    assert normals is not None, "an optimum simulates"
    size, n_p = len(z), run.n_parameters
    n_s = (size - n_p) // len(normals)
    columns = [run.columns(e, n_p, n_s) for e in range(len(normals))]
    hessian = np.zeros((size, size))
    for index, stretches in zip(columns, normals, strict=True):
        hessian[np.ix_(index, index)] += stretches[:, :-1, :-1].sum(axis=0)
    stiff = 0.0 if penalty is None else np.diag(penalty)
    root, undetermined, closely = _looked_at_closely(run, z, *_root_of_inverse(hessian + stiff), stiff)
    roots = [root[index] for index in columns]
    meat = np.zeros((root.shape[1], root.shape[1]))
    for pull, scores in _by_samples(run, z, roots) if closely else map(_in_unit_unknowns, normals, roots):
        meat += long_run_scatter(_without_leverage(pull, scores))
    total = sum(float(stretches[:, -1, -1].sum()) for stretches in normals)
    variance = total / max(run.problem.samples - size, 1)
    return Uncertainty(variance * root @ root.T, root @ meat @ root.T, undetermined)


def of_information(information: np.ndarray, *, by_samples: bool = False) -> Uncertainty:
    """Covariance of the estimates of greatest likelihood, from their ``information`` (d, d): the errors' colour is in it already.

    Args:
        by_samples: whether it was summed in double precision over samples (or frequencies), with nothing taken off it.
    """
    root, undetermined = _root_of_inverse(information, FLAT_BY_SAMPLES if by_samples else FLAT)
    covariance = root @ root.T
    return Uncertainty(covariance, covariance, undetermined)


def _in_unit_unknowns(stretches: np.ndarray, root: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Curvature (C, r, r) and scores (C, r) of stretches (C, d + 1, d + 1), in unknowns of unit covariance that ``root`` (d, r) gives."""
    return root.T @ stretches[:, :-1, :-1] @ root, stretches[:, :-1, -1] @ root


def _by_samples(run: FreeRun, z: np.ndarray, roots: Sequence[np.ndarray]) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """:func:`_in_unit_unknowns` of every experiment from the sensitivities of every sample, where stretches' matrices are not exact enough:
    in the directions that only these samples determine, their rounding errors are larger than all curvature that there is.
    """
    found = run.errors(z)
    assert found is not None, "looked at before"
    for (errors, slopes), root in zip(found, roots, strict=True):
        begins = range(0, len(errors), run.stretch)
        cut = [slice(begin, begin + run.stretch) for begin in begins]
        rows = [slopes[one].reshape(-1, slopes.shape[-1]) @ root for one in cut]
        scores = [own.T @ errors[one].ravel() for own, one in zip(rows, cut, strict=True)]
        yield np.array([own.T @ own for own in rows]), np.array(scores)


def _without_leverage(pull: np.ndarray, scores: np.ndarray) -> np.ndarray:
    """Scores (C, r) of stretches of curvature ``pull`` (C, r, r) in unknowns of unit covariance, as if a stretch had not drawn the estimate
    to itself.

    A start state matters to few stretches; those follow it so closely that their errors say little about its scatter.
    """
    values, vectors = eigh(pull)
    freed = np.einsum("crk,ck,csk->crs", vectors, 1.0 / np.sqrt(np.maximum(1.0 - values, 1e-3)), vectors)
    return np.einsum("crs,cs->cr", freed, scores)


def long_run_scatter(scores: np.ndarray) -> np.ndarray:
    """Covariance (d, d) of the sum of the scores (C, d) of successive stretches, neighbours weighted down with distance (Bartlett)."""
    result = scores.T @ scores
    reach = _bandwidth(scores)
    for lag in range(1, reach + 1):
        weight = 1.0 - lag / (reach + 1)
        product = scores[lag:].T @ scores[:-lag]
        result = result + weight * (product + product.T)
    return result


def _bandwidth(scores: np.ndarray) -> int:
    """How many neighbours are correlated, by Andrews' rule for the Bartlett kernel on first-order autoregressions of the scores."""
    count = len(scores)
    if count < 8:
        return 0
    size = (scores**2).sum(axis=0)
    lagged = (scores[1:] * scores[:-1]).sum(axis=0)
    pole = np.clip(np.where(size > 0, lagged / np.where(size > 0, size, 1.0), 0.0), -0.9, 0.9)
    strength = float(np.mean(4 * pole**2 / ((1 - pole) ** 2 * (1 + pole) ** 2))) if pole.size else 0.0
    return min(int(1.1447 * (strength * count) ** (1 / 3)), count // 4)


def _looked_at_closely(
    run: FreeRun, z: np.ndarray, root: np.ndarray, undetermined: tuple[int, ...], stiff: np.ndarray | float
) -> tuple[np.ndarray, tuple[int, ...], bool]:
    """:func:`_root_of_inverse` from the sensitivities of every sample, and whether that determines more; what is given, where it does not.

    One stretch that nearly leaves its valley outweighs the others so far that what these tell is lost in rounding where less is known of
    that.
    """
    closer = run.by_samples(z) if undetermined and run.simulator.options.precision == "double" else None
    if closer is None:
        return root, undetermined, False
    found = _root_of_inverse(closer + stiff, FLAT_BY_SAMPLES)
    return (*found, True) if len(found[1]) < len(undetermined) else (root, undetermined, False)


def _root_of_inverse(hessian: np.ndarray, rounding: float = FLAT) -> tuple[np.ndarray, tuple[int, ...]]:
    """R (d, r) with R Rᵀ the inverse in the directions of curvature, and the unknowns that take part in one of no curvature."""
    diagonal = np.diag(hessian)
    scale = np.where(diagonal > 0, 1.0 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0)), 0.0)
    values, vectors = eigh(hessian * scale[:, None] * scale[None, :])
    flat = values < rounding * values.max(initial=1e-300)
    involved = set(np.flatnonzero((np.abs(vectors[:, flat]) > 0.1).any(axis=1))) | set(np.flatnonzero(diagonal <= 0))
    root = scale[:, None] * vectors[:, ~flat] / np.sqrt(values[~flat])
    return root, tuple(int(i) for i in sorted(involved))
