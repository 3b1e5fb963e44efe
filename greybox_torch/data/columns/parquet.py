"""The columns of parquet tables that hold numbers or times."""

from __future__ import annotations

from pathlib import Path

from greybox_torch.data.columns.listing import Listing
from greybox_torch.errors import UserError


def parquet_columns(path: Path) -> Listing:
    """Raises UserError for files that are not parquet."""
    import pyarrow as pa
    from pyarrow import parquet

    kinds = pa.types
    held = (
        kinds.is_integer,
        kinds.is_floating,
        kinds.is_boolean,
        kinds.is_decimal,
        kinds.is_timestamp,
        kinds.is_duration,
    )
    try:
        schema = parquet.read_schema(path)
    except pa.ArrowException as error:
        raise UserError(f"{path}: cannot be read as parquet: {' '.join(str(error).split())}") from None
    return Listing(path, tuple(f.name for f in schema if any(is_kind(f.type) for is_kind in held)))
