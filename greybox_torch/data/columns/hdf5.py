"""The columns of HDF5 files: datasets of numbers, groups entered by dots."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from greybox_torch.data.columns.listing import MOST_COLUMNS, Listing, of_shape

_DEEPEST = 12


def hdf5_columns(path: Path) -> Listing:
    """Raises what h5py raises for a damaged file. Links out of the file are left out."""
    return group_columns(path, is_matlab=False)


def group_columns(path: Path, *, is_matlab: bool) -> Listing:
    """As :func:`hdf5_columns`; MATLAB's matrices stand transposed in the file."""
    import h5py

    names: list[str] = []
    numbers: dict[str, float] = {}
    with h5py.File(path, "r") as file:
        for name, dataset in _datasets(file, "", is_matlab, 0):
            shape = tuple(reversed(dataset.shape)) if is_matlab else tuple(dataset.shape)
            number = float(np.asarray(dataset).reshape(-1)[0]) if int(np.prod(shape, dtype=object)) == 1 else None
            for column, found in of_shape(name, shape, number):
                if found is not None:
                    numbers[column] = found
                elif len(names) < MOST_COLUMNS:
                    names.append(column)
    return Listing(path, tuple(names), numbers)


def _datasets(group: Any, prefix: str, is_matlab: bool, depth: int) -> Iterator[tuple[str, Any]]:
    import h5py

    for key in group:
        link = group.get(key, getlink=True)
        if isinstance(link, h5py.ExternalLink | h5py.SoftLink) or (is_matlab and str(key).startswith("#")):
            continue
        item, name = group[key], f"{prefix}{key}"
        if isinstance(item, h5py.Group) and depth < _DEEPEST:
            yield from _datasets(item, f"{name}.", is_matlab, depth + 1)
        elif isinstance(item, h5py.Dataset) and item.shape is not None and item.dtype.kind in "fiub":
            kind = item.attrs.get("MATLAB_class", b"") if is_matlab else b""
            yield from [(name, item)] * (kind not in (b"char", b"cell", b"struct"))
