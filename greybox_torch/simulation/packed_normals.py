"""Normal matrices of many windows and many probes, as the stepper leaves them: lanes last, the lower triangle, products of probes far
apart left out. Putting them into full matrices would cost more than computing them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class PackedNormals:
    """Matrices (W, d, d) of W windows: ``data`` (groups, at least d, at least d, lanes) has the lower triangles, W = groups × lanes of
    which the last may be empty (zero). A window in which something is not finite is all zero once :meth:`sound` has been asked for.
    """

    data: np.ndarray
    windows: int
    size: int

    @staticmethod
    def of(data: np.ndarray, windows: int, size: int) -> PackedNormals:
        """From ``data`` whose last lanes may hold copies."""
        lanes = data.shape[-1]
        if windows % lanes:
            data[-1, ..., windows % lanes :] = 0.0
        return PackedNormals(data, windows, size)

    def rows(self, index: np.ndarray) -> np.ndarray:
        """Rows (W, k, d) of the symmetric matrices."""
        below, beside = self.data[:, index, : self.size], self.data[:, : self.size, index]
        inside = (np.arange(self.size) <= index[:, None])[None, :, :, None]
        return self._unpacked(np.where(inside, below, np.swapaxes(beside, 1, 2)))

    def blocks(self, index: np.ndarray) -> np.ndarray:
        """Blocks (W, K, k, k) of the columns ``index`` (K, k), increasing in every row."""
        row, column = np.maximum(index[:, :, None], index[:, None, :]), np.minimum(index[:, :, None], index[:, None, :])
        return self._unpacked(self.data[:, row, column])

    def diagonal(self) -> np.ndarray:
        """Diagonals (W, d)."""
        at = np.arange(self.size)
        return self._unpacked(self.data[:, at, at])

    def total(self) -> np.ndarray:
        """The sum (d, d) over all windows, symmetric."""
        lower = np.tril(self.data.sum(axis=(0, -1))[: self.size, : self.size])
        return lower + np.tril(lower, -1).T

    def without(self, windows: np.ndarray, columns: np.ndarray) -> PackedNormals:
        """The same with zeros for some ``windows`` (W,) and some ``columns`` (d,), both Boolean."""
        data = self.data.copy()
        lanes = data.shape[-1]
        lost = np.zeros(data.shape[0] * lanes, dtype=bool)
        lost[: self.windows] = windows
        group, lane = np.nonzero(lost.reshape(-1, lanes))
        data[group, :, :, lane] = 0.0
        bad = np.flatnonzero(columns)
        data[:, bad] = 0.0
        data[:, :, bad] = 0.0
        return PackedNormals(data, self.windows, self.size)

    def _unpacked(self, values: np.ndarray) -> np.ndarray:
        """(groups, ..., lanes) -> (W, ...)."""
        moved = np.moveaxis(values, -1, 1)
        return moved.reshape(moved.shape[0] * moved.shape[1], *moved.shape[2:])[: self.windows]
