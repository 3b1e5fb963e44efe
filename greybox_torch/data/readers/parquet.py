"""Parquet tables. Nulls and NaN are missing samples."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

from greybox_torch.data.readers.table import Table, as_vector, require
from greybox_torch.errors import UserError


def read_parquet(path: Path, columns: Collection[str]) -> Table:
    """Reads columns by name. Raises UserError for files that are not parquet and columns that do not hold numbers."""
    import pyarrow as pa
    from pyarrow import parquet

    try:
        with parquet.ParquetFile(path) as file:
            require(path, columns, file.schema_arrow.names)
            table = file.read(columns=list(columns))
    except pa.ArrowException as error:
        raise UserError(f"{path}: cannot be read as parquet: {error}") from None
    vectors = {}
    for column in columns:
        values = table.column(column)
        kind = values.type
        if not (pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_boolean(kind)):
            raise UserError(f'{path}, column "{column}": holds {kind}; expected real numbers')
        vectors[column] = as_vector(path, column, values.cast(pa.float64(), safe=False).to_numpy())
    return Table(path, vectors)
