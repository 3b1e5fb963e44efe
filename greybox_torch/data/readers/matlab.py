"""MATLAB files: versions up to 7 by scipy, version 7.3 (which is HDF5) by h5py. One variable a column."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

import numpy as np

from greybox_torch.data.readers.table import Table, as_vector, require
from greybox_torch.errors import UserError

_HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"


def read_matlab(path: Path, columns: Collection[str]) -> Table:
    """Reads variables by name. Raises UserError for damaged files and for variables that are not vectors of numbers."""
    with path.open("rb") as file:
        head = file.read(512 + len(_HDF5_SIGNATURE))
    is_hdf5 = head.startswith(_HDF5_SIGNATURE) or head.endswith(_HDF5_SIGNATURE)  # MATLAB writes 512 bytes ahead of it
    return _read_v73(path, columns) if is_hdf5 else _read_v5(path, columns)


def _read_v5(path: Path, columns: Collection[str]) -> Table:
    import scipy.io

    try:
        found = [name for name, _, _ in scipy.io.whosmat(path)]
        require(path, columns, found)
        variables = scipy.io.loadmat(path, variable_names=list(columns))
    except UserError:
        raise
    except Exception as error:  # scipy lets many kinds escape from damaged files, down to zlib.error and IndexError
        raise UserError(f"{path}: cannot be read as a MATLAB file: {error}") from None
    vectors = {}
    for column in columns:
        values = variables[column]
        vectors[column] = as_vector(path, column, values.toarray() if hasattr(values, "toarray") else values)
    return Table(path, vectors)


def _read_v73(path: Path, columns: Collection[str]) -> Table:
    import h5py

    with h5py.File(path, "r") as file:
        found = [name for name in map(str, file) if not name.startswith("#")]  # "#refs#" and the like are MATLAB's own
        require(path, columns, found)
        vectors = {}
        for column in columns:
            variable = file[column]
            kind = np.asarray(variable.attrs.get("MATLAB_class", b"")).astype(str).item()
            if not isinstance(variable, h5py.Dataset) or kind in ("char", "cell", "struct"):
                what = {"char": "text", "cell": "cells"}.get(kind, "a structure")
                raise UserError(f'{path}, column "{column}": holds {what}; expected real numbers')
            empty = "MATLAB_empty" in variable.attrs  # MATLAB then stores the shape in the place of values
            vectors[column] = as_vector(path, column, np.empty(0) if empty else variable[()])
    return Table(path, vectors)
