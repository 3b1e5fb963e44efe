"""Which columns a recording has, for all formats: a card names columns, and this is for those who do not know the names yet."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from greybox_torch.data.columns.hdf5 import hdf5_columns
from greybox_torch.data.columns.json_log import json_columns, json_lines_columns
from greybox_torch.data.columns.listing import Listing
from greybox_torch.data.columns.matlab import matlab_columns
from greybox_torch.data.columns.npz import npz_columns
from greybox_torch.data.columns.parquet import parquet_columns
from greybox_torch.data.columns.robot import mcap_columns, ros_bag_columns
from greybox_torch.data.columns.text import text_columns
from greybox_torch.data.readers import READERS, guarded
from greybox_torch.errors import UserError

_LISTERS: dict[str, Callable[[Path], Listing]] = {
    ".csv": text_columns,
    ".tsv": text_columns,
    ".txt": text_columns,
    ".dat": text_columns,
    ".asc": text_columns,
    ".lvm": text_columns,
    ".mat": matlab_columns,
    ".npz": npz_columns,
    ".parquet": parquet_columns,
    ".h5": hdf5_columns,
    ".hdf5": hdf5_columns,
    ".json": json_columns,
    ".jsonl": json_lines_columns,
    ".ndjson": json_lines_columns,
    ".mcap": mcap_columns,
    ".db3": ros_bag_columns,
}


def columns_of(path: Path) -> Listing:
    """The columns of the file at `path`, by the names that its reader knows them by.

    Raises UserError as :func:`read_table` does, and where a reader of the user's own cannot say what a file holds.
    """
    suffix = path.suffix.lower()
    if suffix in READERS and suffix not in _LISTERS:
        raise UserError(
            f'{path}: the reader for "{suffix}" was registered and cannot list columns; expected a card written by hand'
        )
    return guarded(path, _LISTERS)(path)
