"""JSON logs: an object of arrays, a list of records, or one record a line (`.jsonl`). Null and NaN are missing samples.

Nested members are written with dots: "motor.current" is `{"motor": {"current": …}}`, in every record or around an array.
"""

from __future__ import annotations

import io
import json
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.readers.column import Field, Step, inside, root_of, steps_of
from greybox_torch.data.readers.missing_marks import is_missing
from greybox_torch.data.readers.table import NoSuchColumn, Table, as_vector, require
from greybox_torch.data.readers.time_stamps import TimeStamps, is_time_stamp
from greybox_torch.errors import UserError
from greybox_torch.reading import parsed_json, read_text

_EXPECTED = "a log in JSON"


def read_json(path: Path, columns: Collection[str]) -> Table:
    """Reads columns of a JSON file. Raises UserError for files that are not JSON and for columns that do not hold numbers."""
    content = parsed_json(read_text(path, _EXPECTED), f"{path}", _EXPECTED)
    if isinstance(content, list):
        return _from_records(path, content, columns, None)
    if not isinstance(content, dict):
        raise UserError(f"{path}: holds neither an object nor a list; expected arrays by name, or a list of records")
    read = {}
    for column in columns:
        root = root_of(column, content)
        require(path, [column] if root not in content else [], list(content))
        place = f'{path}, column "{column}"'
        found = by_index(content[root] if column == root else inside(place, content[root], steps_of(column)[1:]))
        read[column] = _numbers(place, found)
    return _table(path, read)


def read_json_lines(path: Path, columns: Collection[str]) -> Table:
    """Reads columns of a file with one JSON record a line. Raises UserError, with the line, for whatever is no record."""
    records, lines = [], []
    for line, record in records_of(path):
        records.append(record)
        lines.append(line)
    return _from_records(path, records, columns, lines)


def records_of(path: Path) -> Iterator[tuple[int, Any]]:
    """Line number and content of every line that is not blank. Raises UserError, with the line, for what is not JSON.

    Lines end where those of any text file do, not at the further separators of Unicode, which JSON allows in its texts.
    """
    for line, text in enumerate(io.StringIO(read_text(path, _EXPECTED), newline=None), start=1):
        if text.strip():
            yield line, parsed_json(text, f"{path}, line {line}", "one record a line")


def by_index(value: Any) -> Any:
    """A column whose samples stand by their index, {"0": 1.5, "1": 1.7}, as pandas writes it, as a list; anything else as it is."""
    if isinstance(value, dict) and value and list(value) == [str(k) for k in range(len(value))]:
        return list(value.values())
    return value


def _from_records(path: Path, records: list[Any], columns: Collection[str], lines: list[int] | None) -> Table:
    """One sample from every record. A member that a record lacks is a missing sample; one that all lack is an error."""
    for k, record in enumerate(records):
        if not isinstance(record, dict):
            where = f"line {lines[k]}" if lines else f"entry {k} (the first is 0)"
            raise UserError(
                f"{path}, {where}: found {json.dumps(record)[:40]}, expected a record: an object with members"
            )
    known = list(dict.fromkeys(name for record in records for name in record))
    read = {}
    for column in columns:
        if column in known:
            values = [record.get(column) for record in records]
        else:
            require(path, [column] if root_of(column, known) not in known else [], known)
            values = [_member(record, steps_of(column)) for record in records]
            if records and all(value is None for value in values):
                raise NoSuchColumn(f'{path}: no record has "{column}"; found {", ".join(known)}', column)
        read[column] = _numbers(f'{path}, column "{column}"', values, lines)
    return _table(path, read, lines)


def _table(path: Path, read: dict[str, tuple[NDArray, TimeStamps | None]], lines: list[int] | None = None) -> Table:
    """Of columns, with how dates and times in them were read; None for those that have none."""
    vectors = {column: as_vector(path, column, values) for column, (values, _) in read.items()}
    stamps = {column: found for column, (_, found) in read.items() if found is not None}
    notes = tuple(f'column "{column}" of {path.name}: {one.note}' for column, one in stamps.items() if one.note)
    orders = {column: one.order for column, one in stamps.items() if one.order}
    return Table(path, vectors, lines, dict.fromkeys(stamps, "s"), notes, frozenset(stamps), orders)


def _member(record: Any, steps: list[Step]) -> Any:
    """What the steps lead to in one record; None where it is not there."""
    for step in steps:
        if isinstance(step, Field):
            record = record.get(step.name) if isinstance(record, dict) else None
        elif isinstance(record, list) and step.index < len(record):
            record = record[step.index]
        else:
            return None
    return record


def _numbers(place: str, values: Any, lines: list[int] | None = None) -> tuple[NDArray, TimeStamps | None]:
    if isinstance(values, np.ndarray):
        return values, None
    if not isinstance(values, list):
        raise UserError(f"{place}: found {json.dumps(values, default=str)[:40]}, expected a list of numbers")
    texts = [v for v in values if isinstance(v, str) and not is_missing(v.strip())]
    stamps = TimeStamps(texts) if texts and is_time_stamp(texts[0]) else None
    return np.fromiter(_each(place, values, lines, stamps), dtype=np.float64, count=len(values)), stamps


def _each(place: str, values: list[Any], lines: list[int] | None, stamps: TimeStamps | None) -> Iterator[float]:
    for k, value in enumerate(values):
        if value is None or (isinstance(value, str) and is_missing(value.strip())):
            yield float("nan")
            continue
        line = f"line {lines[k]}, " if lines else ""
        if stamps is not None and isinstance(value, str):
            try:
                yield stamps.seconds(value)
                continue
            except ValueError as error:
                why = f"found {json.dumps(value)[:40]}: {error}"
                raise UserError(f"{place}, {line}sample {k} (the first is 0): {why}") from None
        if isinstance(value, bool | int | float):
            try:
                yield float(value)
                continue
            except OverflowError:
                pass
        shown = json.dumps(value)[:40] if not isinstance(value, int) else "a number of very many digits"
        raise UserError(f"{place}, {line}sample {k} (the first is 0): found {shown}, expected a number")
