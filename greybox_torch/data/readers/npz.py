"""NumPy archives (`numpy.savez`): one array a column."""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Collection
from pathlib import Path

import numpy as np

from greybox_torch.data.readers.table import Table, as_vector, require
from greybox_torch.errors import UserError


def read_npz(path: Path, columns: Collection[str]) -> Table:
    """Reads arrays by name. Raises UserError for archives that NumPy cannot read without unpickling objects."""
    if not zipfile.is_zipfile(path):
        raise UserError(f"{path}: not a NumPy archive; expected a file as numpy.savez writes it")
    column = None
    try:
        with np.load(path, allow_pickle=False) as archive:
            require(path, columns, archive.files)
            vectors = {}
            for column in columns:
                vectors[column] = as_vector(path, column, archive[column])
            return Table(path, vectors)
    except (ValueError, EOFError, zlib.error, zipfile.BadZipFile) as error:
        place = f'{path}, column "{column}"' if column else f"{path}"
        raise UserError(f"{place}: cannot be read as a NumPy archive of numbers: {error}") from None
