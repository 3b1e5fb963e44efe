"""NumPy archives (`numpy.savez`): one array a column, or a column of a matrix as `name[:, k]`."""

from __future__ import annotations

import math
import zipfile
import zlib
from collections.abc import Collection
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.readers.column import inside, root_of, steps_of
from greybox_torch.data.readers.table import Table, as_vector, check_declared, require
from greybox_torch.errors import UserError


def read_npz(path: Path, columns: Collection[str]) -> Table:
    """Reads arrays by name. Raises UserError for archives that NumPy cannot read without unpickling objects."""
    if not zipfile.is_zipfile(path):
        raise UserError(f"{path}: not a NumPy archive; expected a file as numpy.savez writes it")
    column = None
    try:
        with zipfile.ZipFile(path) as archive:
            members = {name.removesuffix(".npy"): name for name in archive.namelist()}
            roots = {column: root_of(column, members) for column in columns}
            require(path, [column for column, root in roots.items() if root not in members], list(members))
            vectors = {}
            for column, root in roots.items():
                values = _array(path, column, archive, members[root])
                if column != root:
                    values = np.asarray(inside(f'{path}, column "{column}"', values, steps_of(column)[1:]))
                vectors[column] = as_vector(path, column, values)
            return Table(path, vectors)
    except UserError:
        raise
    except (
        ValueError,
        EOFError,
        SyntaxError,
        zlib.error,
        zipfile.BadZipFile,
        RuntimeError,
        NotImplementedError,
    ) as error:
        place = f'{path}, column "{column}"' if column else f"{path}"
        raise UserError(
            f"{place}: cannot be read as a NumPy archive of numbers: {' '.join(str(error).split())}"
        ) from None


def _array(path: Path, column: str, archive: zipfile.ZipFile, member: str) -> NDArray:
    """The array of one member. Its header is read first: what it declares has to be what the member holds."""
    size = archive.getinfo(member).file_size
    with archive.open(member) as file:
        shape, dtype = header_of(file)
        if dtype.hasobject:
            raise ValueError("Object arrays cannot be read: they would have to be unpickled")
        count = math.prod(shape)
        check_declared(path, column, count, size // max(dtype.itemsize, 1))
    with archive.open(member) as file:
        return np.lib.format.read_array(file, allow_pickle=False)


def header_of(file: IO[bytes]) -> tuple[tuple[int, ...], np.dtype]:
    """Shape and type of the array that a member holds. Raises ValueError and what Python's parser raises where it is none.

    NumPy's public functions know the formats 1.0 and 2.0. Format 3.0 differs in the names of fields alone, which are UTF-8.
    """
    version = np.lib.format.read_magic(file)
    read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, _, dtype = read(file)
    if version == (3, 0) and dtype.names is not None:
        dtype.names = tuple(name.encode("latin-1").decode() for name in dtype.names)
    return shape, dtype
