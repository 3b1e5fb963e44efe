"""What is left of a learned force, and of laws, where forces in any amounts may act beside them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

INDEPENDENT = 1e-6
"""Singular values below this share of the largest are taken for zero."""

ROUNDING = 1e-12
"""Share of a force's square below which what is left of it is rounding."""


@dataclass(frozen=True)
class LeftBeside:
    """``basis`` (N, k) spans the forces beside, None where there are none, weighted by ``root`` (N,), the roots of the points' weights;
    ``force`` (N,), without weights, is what they leave of the learned one.
    """

    root: np.ndarray
    basis: np.ndarray | None
    force: np.ndarray

    @staticmethod
    def of(beside: np.ndarray | None, force: np.ndarray, weight: np.ndarray) -> LeftBeside:
        """Of a learned ``force`` (N,) beside forces (N, k)."""
        root = np.sqrt(weight)
        if beside is None or not beside.any():
            return LeftBeside(root, None, force)
        columns = beside * root[:, None]
        columns = columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
        vectors, sizes, _ = np.linalg.svd(columns, full_matrices=False)
        whole = LeftBeside(root, vectors[:, sizes > INDEPENDENT * sizes[0]], force)
        return LeftBeside(root, whole.basis, np.where(root > 0, whole.by(force) / np.where(root > 0, root, 1.0), 0.0))

    def share_of(self, force: np.ndarray, lacking: np.ndarray) -> float:
        """Which share of what the forces beside leave of a ``force`` (N,) a law draws that lacks ``lacking`` (N,), weighted; none of what
        is left of it by rounding."""
        left, whole = (float((part**2).sum()) for part in (self.by(force), self.root * force))
        return 1.0 - float((lacking**2).sum()) / left if left > ROUNDING * whole else 0.0

    def columns(self, forces: np.ndarray) -> np.ndarray:
        """What they leave of forces (N, m), weighted; zero of one of which that is rounding, so that it has no size beside."""
        left, whole = self.by(forces), self.root[:, None] * forces
        return np.where((left**2).sum(axis=0) > ROUNDING * (whole**2).sum(axis=0), left, 0.0)

    def by(self, forces: np.ndarray) -> np.ndarray:
        """What they leave of forces (N,) or (N, m), weighted."""
        weighted = forces * (self.root if forces.ndim == 1 else self.root[:, None])
        return weighted if self.basis is None else weighted - self.basis @ (self.basis.T @ weighted)
