"""The fleet's table as a Parquet file."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.fleets.row import Row

TABLE = "fleet.parquet"


def parquet(rows: Sequence[Row]) -> bytes:
    """The rows with the columns of :class:`Row`; ``parameters`` is a list of name, value, standard deviation and unit."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    texts = "dataset card answer machine recorded title model sentence effect port mechanism parameter unit"
    texts += " failure message report fingerprint"
    numbers = "confidence probability value std fit_before fit_after seconds"
    parameter = pa.struct(
        [("name", pa.string()), ("value", pa.float64()), ("std", pa.float64()), ("unit", pa.string())]
    )
    types = {
        **dict.fromkeys(texts.split(), pa.string()),
        **dict.fromkeys(numbers.split(), pa.float64()),
        "complete": pa.bool_(),
        "parameters": pa.list_(parameter),
    }
    lines = [
        row.as_json() | {"parameters": [{"name": name, **entry} for name, entry in row.parameters.items()]}
        for row in rows
    ]
    schema = pa.schema([(name, types[name]) for name in Row.__dataclass_fields__])
    sink = pa.BufferOutputStream()
    pq.write_table(pa.Table.from_pylist(lines, schema=schema), sink)
    return sink.getvalue().to_pybytes()
