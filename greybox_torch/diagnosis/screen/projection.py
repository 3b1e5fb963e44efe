"""Regressors of equation errors beside the model's free parameters: what they explain, and how likely so much is by chance.

Chance is judged by blocks of neighbouring stretches, within which errors may be correlated as they like.

Source: K.-Y. Liang, S. L. Zeger, "Longitudinal data analysis using generalized linear models", Biometrika 73, 1986.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import fdtrc

from greybox_torch.estimate.equation_error import EquationError
from greybox_torch.linear_algebra import solve

BLOCKS = 32
"""Into how many blocks a record is cut at most."""

PER_BLOCK = 4
"""Stretches that a block has at least."""


@dataclass(frozen=True)
class Projection:
    """A view's ``errors`` without what its free parameters explain, and the ``basis`` by which that is taken out of regressors as well.

    ``blocks``: to which of ``count`` stretches of time every error belongs.
    """

    errors: np.ndarray
    basis: np.ndarray
    blocks: np.ndarray
    count: int

    @staticmethod
    def of(view: EquationError) -> Projection:
        """Of a view at its present parameters, their weak holds among the rows."""
        errors, slopes = view.linearised
        held = np.hstack([slopes, np.diag(np.sqrt(view.hold))])
        size = np.sqrt((held**2).sum(axis=1))
        basis, _ = np.linalg.qr((held / np.where(size > 0, size, 1.0)[:, None]).T)
        padded = np.append(errors, np.zeros(len(view.hold)))
        count = max(2, min(BLOCKS, view.count // PER_BLOCK))
        blocks = np.repeat(np.arange(count), np.diff(np.linspace(0, view.count, count + 1).astype(int)))
        return Projection(padded - basis @ (basis.T @ padded), basis, np.tile(blocks, len(view.scales)), count)

    def tried(self, columns: np.ndarray) -> tuple[float, float, np.ndarray]:
        """Of regressors (k, R M): the share of the errors that they explain, how likely that is by chance, and their sizes (k,)."""
        padded = np.hstack([columns, np.zeros((len(columns), len(self.errors) - columns.shape[1]))])
        left = padded - (padded @ self.basis) @ self.basis.T
        length = np.sqrt((left**2).sum(axis=1))
        size = np.sqrt((padded**2).sum(axis=1))
        usable = np.isfinite(size) & (length > 1e-6 * size)
        if not usable.all():
            return 0.0, 1.0, np.zeros(len(columns))
        unit = left / length[:, None]
        gram, product = unit @ unit.T + 1e-9 * np.eye(len(unit)), unit @ self.errors
        found = solve(gram, product)
        explained = float(product @ found) / max(float(self.errors @ self.errors), 1e-300)
        remains = self.errors - found @ unit
        return explained, self._chance(unit, remains, product), found / length

    def _chance(self, unit: np.ndarray, remains: np.ndarray, product: np.ndarray) -> float:
        """The probability of products as large if the regressors were none of the errors', by the spread of blocks."""
        count, k = self.count, len(unit)
        if count <= k:
            return 1.0
        each = (unit * remains)[:, : len(self.blocks)]
        sums = np.array([np.bincount(self.blocks, weights=row, minlength=count) for row in each])
        spread = sums @ sums.T
        spread += 1e-12 * (np.trace(spread) + float(product @ product)) * np.eye(k)
        ratio = float(product @ solve(spread, product)) * (count - k) / (k * count)
        return float(fdtrc(k, count - k, max(ratio, 0.0)))
