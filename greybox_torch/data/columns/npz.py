"""The columns of NumPy archives: arrays, and columns of matrices. Only headers are read, but for single numbers."""

from __future__ import annotations

import math
import zipfile
from pathlib import Path

import numpy as np

from greybox_torch.data.columns.listing import Listing, of_shape
from greybox_torch.data.readers.npz import header_of
from greybox_torch.errors import UserError


def npz_columns(path: Path) -> Listing:
    """Raises UserError for what is no archive. Arrays of objects and of text are left out."""
    if not zipfile.is_zipfile(path):
        raise UserError(f"{path}: not a NumPy archive; expected a file as numpy.savez writes it")
    names: list[str] = []
    numbers: dict[str, float] = {}
    with zipfile.ZipFile(path) as archive:
        for member in archive.namelist():
            with archive.open(member) as file:
                shape, dtype = header_of(file)
                names += [f"{member.removesuffix('.npy')}.{name}" for name in (dtype.names or ()) if len(shape) == 1]
                if dtype.kind not in "fiubmM":
                    continue
                number = None
                if math.prod(shape) == 1 and dtype.kind in "fiub":
                    number = float(np.frombuffer(file.read(dtype.itemsize), dtype)[0])
            for column, found in of_shape(member.removesuffix(".npy"), shape, number):
                if found is None:
                    names.append(column)
                else:
                    numbers[column] = found
    return Listing(path, tuple(names), numbers)
