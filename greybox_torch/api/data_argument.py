"""The argument ``data`` of the public functions, checked without torch, which takes seconds to import."""

from __future__ import annotations

from os import PathLike
from typing import Any

from greybox_torch.data import DataSet, load_dataset
from greybox_torch.errors import ArgumentError, Kind

Data = DataSet | str | PathLike[str]
"""A data set, or the card that it is read from."""


def check_data(data: Any) -> DataSet:
    """The data set, read where ``data`` is the place of a card.

    Raises:
        ArgumentError: it is neither.
        UserError: the card, or a recording, is at fault.
    """
    if isinstance(data, str | PathLike):
        return load_dataset(data)
    if not isinstance(data, DataSet):
        raise ArgumentError(
            "data", Kind.of(data), "expected a DataSet, as load_dataset() or DataSet([…]) make it, or a card by path"
        )
    return data
