"""Normal matrices that lack products of probes far apart: where their entries stand, and that nothing else is lost."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from greybox_torch.simulation.packed_normals import Layout, PackedNormals

TILE = 4


@st.composite
def layouts(draw) -> Layout:
    """First, close and band in whole squares, as the compiled stepper has them."""
    width = draw(st.integers(1, 8))
    close = draw(st.integers(0, width))
    first = draw(st.integers(0, width))
    band = draw(st.integers(0, 3))
    return Layout(width * TILE, first * TILE, close * TILE, band * TILE, TILE)


def wanted(layout: Layout) -> np.ndarray:
    """Which entries of the lower triangle are kept, by what the layout says."""
    row, column = np.indices((layout.width, layout.width))
    apart = row // TILE * TILE - column // TILE * TILE
    return (row >= layout.close) | (column < layout.first) | (apart <= layout.band)


@given(layouts())
def test_every_entry_has_a_place_of_its_own(layout: Layout) -> None:
    row, column = np.tril_indices(layout.width)
    places, kept = layout.places(row, column)
    np.testing.assert_array_equal(kept, wanted(layout)[row, column])
    assert len(set(places[kept])) == kept.sum()
    assert (places >= 0).all() and (places < layout.size).all()


@given(layouts(), st.integers(1, 5), st.integers(0, 2**32 - 1))
def test_what_is_kept_comes_back_by_rows_blocks_diagonal_and_sum(layout: Layout, windows: int, seed: int) -> None:
    lanes, size = 2, layout.width - 1
    groups = -(-windows // lanes)
    matrices = np.random.default_rng(seed).normal(size=(groups * lanes, layout.width, layout.width))
    row, column = np.tril_indices(layout.width)
    places, kept = layout.places(row, column)
    data = np.zeros((groups, layout.size, lanes))
    stored = matrices[:, row[kept], column[kept]].reshape(groups, lanes, -1)
    data[:, places[kept]] = np.swapaxes(stored, 1, 2)
    lower = np.where(wanted(layout), np.tril(matrices), 0.0)[:windows, :size, :size]
    full = lower + np.swapaxes(np.tril(lower, -1), 1, 2)
    packed = PackedNormals.of(data, windows, size, layout)
    at = np.arange(size)
    np.testing.assert_array_equal(packed.rows(at), full)
    np.testing.assert_array_equal(packed.diagonal(), np.einsum("wii->wi", full))
    np.testing.assert_allclose(packed.total(), full.sum(axis=0), atol=1e-12)
    pairs = np.stack([at, at[::-1]], axis=1)
    np.testing.assert_array_equal(packed.blocks(pairs), full[:, pairs[:, :, None], pairs[:, None, :]])
    bad = at == seed % size
    left = np.where(bad[:, None] | bad, 0.0, full)
    left[0] = 0.0
    first = np.arange(windows) == 0
    np.testing.assert_array_equal(packed.without(first, bad).rows(at), left)
