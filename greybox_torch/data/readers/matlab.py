"""MATLAB files: versions up to 7 by scipy, version 7.3 (which is HDF5) by h5py.

A variable is a column; fields of structures are "log.motor.u", columns of a matrix "Y[:, 1]", elements of cells "runs[0].u". Whatever
else the file holds, objects of classes included, is left alone.
"""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

import numpy as np

from greybox_torch.data.readers.column import inside, root_of, steps_of
from greybox_torch.data.readers.hdf5 import read_groups
from greybox_torch.data.readers.matlab_directory import variables_of
from greybox_torch.data.readers.table import Table, as_vector, check_declared, require
from greybox_torch.errors import UserError

_HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"


def read_matlab(path: Path, columns: Collection[str]) -> Table:
    """Reads variables by name. Raises UserError for damaged files and for variables that are not vectors of numbers."""
    with path.open("rb") as file:
        head = file.read(512 + len(_HDF5_SIGNATURE))
    is_hdf5 = head.startswith(_HDF5_SIGNATURE) or head.endswith(_HDF5_SIGNATURE)  # MATLAB writes 512 bytes ahead of it
    return read_groups(path, columns, is_matlab=True) if is_hdf5 else _read_v5(path, columns)


def _read_v5(path: Path, columns: Collection[str]) -> Table:
    import scipy.io

    try:
        found = variables_of(path)
        roots = {column: root_of(column, found) for column in columns}
        require(path, [column for column, root in roots.items() if root not in found], list(found))
        for column, root in roots.items():
            check_declared(path, column, found[root].samples, found[root].most_samples)
        variables = scipy.io.loadmat(path, variable_names=list(dict.fromkeys(roots.values())))
    except UserError:
        raise
    except Exception as error:  # scipy lets many kinds escape from damaged files, down to zlib.error and IndexError
        raise UserError(f"{path}: cannot be read as a MATLAB file: {' '.join(str(error).split())}") from None
    vectors = {}
    for column, root in roots.items():
        if root not in variables:
            raise UserError(
                f'{path}, column "{column}": holds an object of a class of MATLAB\'s; expected real numbers'
            )
        values = variables[root]
        if column != root:
            values = inside(f'{path}, column "{column}"', values, steps_of(column)[1:])
        vectors[column] = as_vector(
            path, column, np.asarray(values.toarray() if hasattr(values, "toarray") else values)
        )
    return Table(path, vectors)
