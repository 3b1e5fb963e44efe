"""The columns of JSON logs: arrays by name, members of records."""

from __future__ import annotations

import json
from collections.abc import Mapping
from itertools import islice
from pathlib import Path
from typing import Any

from greybox_torch.data.columns.listing import Listing, is_sample
from greybox_torch.data.readers.json_log import by_index, records_of
from greybox_torch.errors import UserError
from greybox_torch.reading import read_json

_LOOKED_AT = 200
"""Records of which members are listed."""


def json_columns(path: Path) -> Listing:
    """Raises UserError for what is not JSON, or neither an object nor a list."""
    content = read_json(path, "a log in JSON")
    if isinstance(content, list):
        return _of_records(path, content[:_LOOKED_AT])
    if not isinstance(content, dict):
        raise UserError(f"{path}: holds neither an object nor a list; expected arrays by name, or a list of records")
    return Listing.of_parts(path, ((name, by_index(value)) for name, value in content.items()))


def json_lines_columns(path: Path) -> Listing:
    """Raises UserError for lines that are no records."""
    return _of_records(path, [record for _, record in islice(records_of(path), _LOOKED_AT)])


def _of_records(path: Path, records: list[Any]) -> Listing:
    names: dict[str, None] = {}
    for record in records:
        if not isinstance(record, dict):
            raise UserError(f"{path}: found {json.dumps(record)[:40]}, expected a record: an object with members")
        names.update(dict.fromkeys(_members(record, "")))
    return Listing(path, tuple(names))


def _members(record: Mapping[str, Any], prefix: str) -> list[str]:
    found: list[str] = []
    for name, value in record.items():
        if isinstance(value, Mapping):
            found += _members(value, f"{prefix}{name}.")
        elif value is not None and is_sample(value):
            found.append(prefix + name)
    return found
