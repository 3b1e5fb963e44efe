"""MATLAB files: version 4 by scipy, versions 5 to 7 here, version 7.3 (which is HDF5) by h5py.

A variable is a column; fields of structures are "log.motor.u", columns of a matrix "Y[:, 1]", elements of cells "runs[0].u". Whatever
else the file holds, objects of classes included, is left alone.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.readers.column import inside, root_of, steps_of
from greybox_torch.data.readers.hdf5 import read_groups
from greybox_torch.data.readers.matlab_v5 import Other, is_version_5, variables_of
from greybox_torch.data.readers.table import Table, as_vector, require
from greybox_torch.errors import UserError

_HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"


def read_matlab(path: Path, columns: Collection[str]) -> Table:
    """Reads variables by name. Raises UserError for damaged files and for variables that are not vectors of numbers."""
    return read_groups(path, columns, is_matlab=True) if is_hdf5(path) else _read_v5(path, columns)


def is_hdf5(path: Path) -> bool:
    """Whether the file is of version 7.3."""
    with path.open("rb") as file:
        head = file.read(512 + len(_HDF5_SIGNATURE))
    return head.startswith(_HDF5_SIGNATURE) or head.endswith(_HDF5_SIGNATURE)  # MATLAB writes 512 bytes ahead of it


def values_of(path: Path) -> dict[str, Any]:
    """All variables of a file of version 4 to 7 but that without a name, in which MATLAB keeps what objects of classes hold. Raises what a
    damaged file makes readers raise.
    """
    if not is_version_5(path):
        return {name: value for name, value in _version_4(path).items() if not name.startswith("__")}
    held = variables_of(path)
    return {name: held.value(name) for name in held.places if name}


def _read_v5(path: Path, columns: Collection[str]) -> Table:
    try:
        held = variables_of(path) if is_version_5(path) else None
        found = _version_4(path) if held is None else dict.fromkeys(name for name in held.places if name)
        roots = {column: root_of(column, found) for column in columns}
        require(path, [column for column, root in roots.items() if root not in found], list(found))
        values = {root: found[root] if held is None else held.value(root) for root in dict.fromkeys(roots.values())}
    except UserError:
        raise
    except Exception as error:  # damaged files fail in many ways, down to zlib.error and RecursionError
        said = " ".join(str(error).split())
        raise UserError(f"{path}: cannot be read as a MATLAB file: {said}") from None
    return Table(path, {column: _vector(path, column, root, values[root]) for column, root in roots.items()})


def _vector(path: Path, column: str, root: str, value: Any) -> NDArray[np.float64]:
    place = f'{path}, column "{column}"'
    value = value if column == root else inside(place, value, steps_of(column)[1:])
    if isinstance(value, Mapping):
        raise UserError(
            f"{place}: holds a structure; expected real numbers (its fields are {', '.join(map(str, value))})"
        )
    found = np.asarray(value)
    if found.dtype.kind == "O" and any(isinstance(entry, Other) for entry in found.flat):
        raise UserError(f"{place}: holds an object of a class of MATLAB's; expected real numbers")
    return as_vector(path, column, found)


def _version_4(path: Path) -> dict[str, Any]:
    import scipy.io

    return scipy.io.loadmat(path)
