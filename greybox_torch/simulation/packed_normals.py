"""Normal matrices of many windows and many probes, as the stepper leaves them: lanes last, the lower triangle, products of probes far
apart left out. Putting them into full matrices would cost more than computing them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Layout:
    """Where the entries of a matrix of ``width`` rows stand, one after another.

    Of the rows before ``close`` the columns before ``first`` are kept, and those that stand no farther left than ``band`` squares of side
    ``tile`` count (``band`` is a multiple of it). The other rows are whole.
    """

    width: int
    first: int = 0
    close: int = 0
    band: int = 0
    tile: int = 1

    @property
    def narrow(self) -> int:
        """Entries of a row before ``close``."""
        return self.first + self.band + self.tile

    @property
    def size(self) -> int:
        """Entries of all rows."""
        return self.close * self.narrow + (self.width - self.close) * self.width

    def places(self, row: np.ndarray, column: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Where the entries of ``row`` and ``column`` (in the lower triangle) stand, and whether they are kept."""
        left = row // self.tile * self.tile - self.band
        inside = np.where(column < self.first, column, self.first + column - left)
        whole = row >= self.close
        below = self.close * self.narrow + (row - self.close) * self.width + column
        kept = whole | (column < self.first) | (column >= left)
        return np.where(kept, np.where(whole, below, row * self.narrow + inside), 0), kept


@dataclass(frozen=True)
class PackedNormals:
    """Matrices (W, d, d) of W windows: ``data`` (groups, entries, lanes) has the lower triangles by ``layout``, W = groups × lanes of
    which the last may be empty (zero). What the layout leaves out is zero.
    """

    data: np.ndarray
    windows: int
    size: int
    layout: Layout

    @staticmethod
    def of(data: np.ndarray, windows: int, size: int, layout: Layout) -> PackedNormals:
        """From ``data`` whose last lanes may hold copies."""
        lanes = data.shape[-1]
        if windows % lanes:
            data[-1, ..., windows % lanes :] = 0.0
        return PackedNormals(data, windows, size, layout)

    @staticmethod
    def whole(matrices: np.ndarray, windows: int) -> PackedNormals:
        """From whole ``matrices`` (groups, d, d, lanes)."""
        groups, size, _, lanes = matrices.shape
        return PackedNormals.of(matrices.reshape(groups, size * size, lanes), windows, size, Layout(size))

    def rows(self, index: np.ndarray) -> np.ndarray:
        """Rows (W, k, d) of the symmetric matrices."""
        return self._entries(index[:, None], np.arange(self.size))

    def blocks(self, index: np.ndarray) -> np.ndarray:
        """Blocks (W, K, k, k) of the columns ``index`` (K, k)."""
        return self._entries(index[:, :, None], index[:, None, :])

    def diagonal(self) -> np.ndarray:
        """Diagonals (W, d)."""
        at = np.arange(self.size)
        return self._entries(at, at)

    def total(self) -> np.ndarray:
        """The sum (d, d) over all windows, symmetric."""
        at = np.arange(self.size)
        places, kept = self.layout.places(*_lower(at[:, None], at))
        return np.where(kept, self.data.sum(axis=(0, -1))[places], 0.0)

    def without(self, windows: np.ndarray, columns: np.ndarray) -> PackedNormals:
        """The same with zeros for some ``windows`` (W,) and some ``columns`` (d,), both Boolean."""
        data = self.data.copy()
        lanes = data.shape[-1]
        lost = np.zeros(data.shape[0] * lanes, dtype=bool)
        lost[: self.windows] = windows
        group, lane = np.nonzero(lost.reshape(-1, lanes))
        data[group, :, lane] = 0.0
        places, kept = self.layout.places(*_lower(np.flatnonzero(columns)[:, None], np.arange(self.size)))
        data[:, places[kept]] = 0.0
        return PackedNormals(data, self.windows, self.size, self.layout)

    def _entries(self, row: np.ndarray, column: np.ndarray) -> np.ndarray:
        """Entries (W, ...) of all matrices."""
        places, kept = self.layout.places(*_lower(row, column))
        values = self.data[:, places]
        if not kept.all():
            values[:, ~kept] = 0.0
        moved = np.moveaxis(values, -1, 1)
        return moved.reshape(moved.shape[0] * moved.shape[1], *moved.shape[2:])[: self.windows]


def _lower(row: np.ndarray, column: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same entries in the lower triangle."""
    return np.maximum(row, column), np.minimum(row, column)
