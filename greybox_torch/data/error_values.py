"""Numbers and texts that a logger writes where it has no value, and that the card says: read as missing samples."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from greybox_torch.data.card_channels import ChannelEntry
from greybox_torch.data.expression import Expression
from greybox_torch.data.readers.table import Table
from greybox_torch.data.source import Read


def without_error_values(read: Read, channels: Mapping[str, ChannelEntry], formulas: Mapping[str, Expression]) -> Read:
    """A `read` whose tables have NaN where a column holds an error value of a channel that is made of it, before anything is done to it.

    Args:
        formulas: how the channels come from columns, by channel.
    """
    marked: dict[str, list[float]] = {}
    texts: set[tuple[str, str]] = set()
    for name, formula in formulas.items():
        for column in formula.columns:
            marked.setdefault(column, []).extend(channels[name].error_values)
            texts |= {(column, mark) for mark in channels[name].missing_marks}
    if not any(marked.values()) and not texts:
        return read

    def reading(path: Path, columns: tuple[str, ...]) -> Table:
        table = read(path, columns, tuple(sorted(texts))) if texts else read(path, columns)
        own = {column: _cleared(values, marked.get(column, [])) for column, values in table.columns.items()}
        return replace(table, columns=own)

    return reading


def _cleared(values: np.ndarray, errors: list[float]) -> np.ndarray:
    """Files may hold numbers in single precision, in which 359.978 is another."""
    single = np.array(errors, dtype=np.float32).astype(np.float64)
    return np.where(np.isin(values, [*errors, *single]), np.nan, values) if errors else values
