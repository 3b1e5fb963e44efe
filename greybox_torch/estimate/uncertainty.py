"""Standard deviations of estimates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.estimate.free_run import FreeRun


@dataclass(frozen=True)
class Uncertainty:
    """Covariances (d, d) of the unknowns z.

    ``plain`` is σ² (JᵀJ)⁻¹, right where the residuals are white. ``sandwich`` replaces its middle by the scatter of the score over
    blocks of the record, right where they are coloured, as they are whenever physics is missing. ``undetermined`` lists the indices
    of unknowns that the data do not determine; their standard deviation is infinite.
    """

    plain: np.ndarray
    sandwich: np.ndarray
    undetermined: tuple[int, ...]

    def deviations(self, kind: str = "plain") -> np.ndarray:
        """Standard deviations (d,) of ``kind`` "plain" or "sandwich"."""
        result = np.sqrt(np.maximum(np.diag(getattr(self, kind)), 0.0))
        result[list(self.undetermined)] = np.inf
        return result


def uncertainty(run: FreeRun, z: np.ndarray, *, blocks: int = 40) -> Uncertainty:
    """Covariance of the estimates at the optimum ``z`` (d,).

    Source: L. Ljung, "System Identification: Theory for the User", 2nd ed., ch. 9; sandwich with block sums after H. White (1982).
    """
    found = run.residuals(z)
    size, n_p = len(z), run.n_parameters
    n_s = (size - n_p) // len(found[0])
    hessian, meat = np.zeros((size, size)), np.zeros((size, size))
    total, count = 0.0, 0
    for e, (error, slope) in enumerate(zip(*found, strict=True)):
        index = run.columns(e, n_p, n_s)
        hessian[np.ix_(index, index)] += slope.T @ slope
        total, count = total + float(error @ error), count + len(error)
        pieces = max(2, round(blocks * len(error) / sum(len(r) for r in found[0])))
        for part in np.array_split(np.arange(len(error)), pieces):
            score = slope[part].T @ error[part]
            meat[np.ix_(index, index)] += np.outer(score, score)
    inverse, undetermined = _inverse(hessian)
    variance = total / max(count - size, 1)
    return Uncertainty(variance * inverse, inverse @ meat @ inverse, undetermined)


def _inverse(hessian: np.ndarray) -> tuple[np.ndarray, tuple[int, ...]]:
    """The inverse in scaled unknowns, and the unknowns that take part in a direction of no curvature."""
    diagonal = np.diag(hessian)
    scale = np.where(diagonal > 0, 1.0 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0)), 0.0)
    values, vectors = np.linalg.eigh(hessian * scale[:, None] * scale[None, :])
    flat = values < 1e-12 * values.max(initial=1e-300)
    involved = set(np.flatnonzero((np.abs(vectors[:, flat]) > 0.1).any(axis=1))) | set(np.flatnonzero(diagonal <= 0))
    inverse = (vectors[:, ~flat] / values[~flat]) @ vectors[:, ~flat].T
    return inverse * scale[:, None] * scale[None, :], tuple(int(i) for i in sorted(involved))
