"""The argument ``data`` of the public functions, checked without torch, which takes seconds to import."""

from __future__ import annotations

from typing import Any

from greybox_torch.data import DataSet
from greybox_torch.errors import ArgumentError, Kind


def check_data(data: Any) -> DataSet:
    """Raises ArgumentError where ``data`` is not a data set."""
    if not isinstance(data, DataSet):
        raise ArgumentError("data", Kind.of(data), "expected a DataSet, as load_dataset() or DataSet([…]) make it")
    return data
