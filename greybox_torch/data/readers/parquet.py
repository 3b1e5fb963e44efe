"""Parquet tables. Nulls and NaN are missing samples; dates and times are seconds since 1970."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from greybox_torch.data.readers.table import MOST_SAMPLES, Table, as_vector, check_declared, require
from greybox_torch.errors import UserError


def read_parquet(path: Path, columns: Collection[str]) -> Table:
    """Reads columns by name. Raises UserError for files that are not parquet and columns that do not hold numbers."""
    import pyarrow as pa
    from pyarrow import parquet

    try:
        with parquet.ParquetFile(path) as file:
            names = file.schema_arrow.names
            require(path, columns, names)
            for column in columns:
                if names.count(column) > 1:
                    raise UserError(f'{path}: {names.count(column)} columns are named "{column}"; expected one')
                check_declared(path, column, file.metadata.num_rows, MOST_SAMPLES)
            table = file.read(columns=list(columns))
    except pa.ArrowException as error:
        raise UserError(f"{path}: cannot be read as parquet: {' '.join(str(error).split())}") from None
    vectors = {column: as_vector(path, column, _numbers(path, column, table)) for column in columns}
    return Table(path, vectors, stamps=frozenset(c for c in columns if pa.types.is_timestamp(table.column(c).type)))


def _numbers(path: Path, column: str, table: Any) -> NDArray:
    import pyarrow as pa

    values = table.column(column)
    kind = values.type
    if pa.types.is_timestamp(kind) or pa.types.is_duration(kind):
        return values.to_numpy()
    if not (
        pa.types.is_integer(kind)
        or pa.types.is_floating(kind)
        or pa.types.is_boolean(kind)
        or pa.types.is_decimal(kind)
    ):
        raise UserError(f'{path}, column "{column}": holds {kind}; expected real numbers')
    return values.cast(pa.float64(), safe=False).to_numpy()
