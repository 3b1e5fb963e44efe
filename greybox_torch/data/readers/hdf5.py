"""HDF5 files, MATLAB's version 7.3 among them. Groups and structures are entered with dots or slashes: "motor.u", "motor/u".

Nothing is followed out of the file: external links, external storage and virtual datasets are refused.
"""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.readers.column import Element, Field, Line, Step, inside, root_of, steps_of
from greybox_torch.data.readers.table import MOST_UNPACKED, Table, as_vector, check_declared, require
from greybox_torch.errors import UserError, did_you_mean


def read_hdf5(path: Path, columns: Collection[str]) -> Table:
    """Reads datasets by name. Raises UserError for damaged files and for datasets that are not vectors of numbers."""
    return read_groups(path, columns, is_matlab=False)


def read_groups(path: Path, columns: Collection[str], *, is_matlab: bool) -> Table:
    """As :func:`read_hdf5`; MATLAB's matrices stand transposed in the file, and its cells are references."""
    import h5py

    vectors = {}
    with h5py.File(path, "r") as file:
        found = [
            name for name in map(str, file) if not (is_matlab and name.startswith("#"))
        ]  # "#refs#" is MATLAB's own
        for column in columns:
            dotted = column if column in found else column.strip("/").replace("/", ".")
            root = root_of(dotted, found)
            require(path, [column] if root not in found else [], found)
            steps = [] if dotted == root else steps_of(dotted)[1:]
            vectors[column] = as_vector(path, column, _values(path, column, file, root, steps, is_matlab))
    return Table(path, vectors)


def _values(path: Path, column: str, file: Any, root: str, steps: list[Step], is_matlab: bool) -> NDArray:
    import h5py

    place = f'{path}, column "{column}"'
    item, rest = _member(place, file, root), list(steps)
    while rest and not isinstance(rest[0], Line):
        step = rest.pop(0)
        if isinstance(step, Field) and isinstance(item, h5py.Group):
            item = _member(place, item, step.name)
        elif isinstance(step, Element) and isinstance(item, h5py.Dataset) and item.dtype.kind == "O":
            item = _referred(place, file, item, step.index)
        else:
            raise UserError(f"{place}: what stands before {_shown(step)} has no such part; expected a group or a list")
    values = _read(path, column, item, is_matlab)
    return np.asarray(inside(place, values, rest)) if rest else values


def _member(place: str, group: Any, name: str) -> Any:
    import h5py

    if name not in group and group.get(name, getlink=True) is None:
        names = [str(n) for n in group]
        raise UserError(f"{place}: no {name!r} in it{did_you_mean(name, names)}; found {', '.join(names) or 'nothing'}")
    if isinstance(group.get(name, getlink=True), h5py.ExternalLink):
        raise UserError(f"{place}: is a link into another file; expected numbers in this one")
    try:
        return group[name]
    except KeyError:
        raise UserError(f"{place}: is a link to nothing; expected numbers") from None


def _referred(place: str, file: Any, cells: Any, index: int) -> Any:
    count = int(np.prod(cells.shape))
    if index >= count:
        raise UserError(f"{place}: [{index}] is not among its {count} elements; the first is [0]")
    reference = cells[np.unravel_index(index, cells.shape)]
    return file[reference]


def _read(path: Path, column: str, dataset: Any, is_matlab: bool) -> NDArray:
    import h5py

    place = f'{path}, column "{column}"'
    kind = np.asarray(dataset.attrs.get("MATLAB_class", b"")).astype(str).item() if is_matlab else ""
    if not isinstance(dataset, h5py.Dataset) or kind in ("char", "cell", "struct"):
        parts = f" with {', '.join(map(str, dataset))}" if isinstance(dataset, h5py.Group) and len(dataset) else ""
        what = {"char": "text", "cell": "cells"}.get(kind, f"a structure{parts}")
        raise UserError(f"{place}: holds {what}; expected real numbers")
    if is_matlab and "MATLAB_empty" in dataset.attrs:  # MATLAB then stores the shape in the place of values
        return np.empty(0)
    if dataset.shape is None:
        raise UserError(f"{place}: holds nothing; expected real numbers")
    if dataset.is_virtual or dataset.external:
        raise UserError(f"{place}: its numbers stand in other files; expected numbers in this one")
    check_declared(path, column, int(np.prod(dataset.shape, dtype=object)), _most_samples(dataset))
    values = np.asarray(dataset[()])
    return values.T if is_matlab and values.ndim == 2 else values


def _most_samples(dataset: Any) -> int:
    """What the bytes that are stored of a dataset can at most be unpacked to. All filters pack but those that reorder or check."""
    import h5py

    created = dataset.id.get_create_plist()
    filters = [created.get_filter(k)[0] for k in range(created.get_nfilters())]
    packing = sum(one not in (h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_FLETCHER32) for one in filters)
    return dataset.id.get_storage_size() * MOST_UNPACKED**packing // max(dataset.dtype.itemsize, 1) + 1


def _shown(step: Step) -> str:
    return f".{step.name}" if isinstance(step, Field) else f"[{step.index}]"
