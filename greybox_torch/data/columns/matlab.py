"""The columns of MATLAB files: variables, fields of structures, elements of cells, columns of matrices."""

from __future__ import annotations

from pathlib import Path

from greybox_torch.data.columns.hdf5 import group_columns
from greybox_torch.data.columns.listing import Listing
from greybox_torch.data.readers.matlab import is_hdf5, values_of
from greybox_torch.errors import UserError


def matlab_columns(path: Path) -> Listing:
    """Raises UserError for damaged files. Objects of classes are left out."""
    if is_hdf5(path):
        return group_columns(path, is_matlab=True)
    try:
        return Listing.of_parts(path, iter(values_of(path).items()))
    except UserError:
        raise
    except Exception as error:  # damaged files fail in many ways
        raise UserError(f"{path}: cannot be read as a MATLAB file: {' '.join(str(error).split())}") from None
