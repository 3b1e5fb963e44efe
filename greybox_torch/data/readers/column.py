"""Columns inside nested files: "motor.current", "runs[2].u", "Y[:, 1]".

A name that stands in a file as it is always wins; only one that does not is taken apart. Indices count from zero.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from greybox_torch.errors import UserError, did_you_mean

_PIECE = re.compile(
    r"(?P<field>[^.\[\]]+)|\[\s*(?P<index>\d{1,9})\s*\]|\[\s*:\s*,\s*(?P<column>\d{1,9})\s*\]|\[\s*(?P<row>\d{1,9})\s*,\s*:\s*\]"
)


@dataclass(frozen=True)
class Field:
    """A member of a structure, a group or an object, by name."""

    name: str


@dataclass(frozen=True)
class Element:
    """An element of a list, an array of structures or of cells."""

    index: int


@dataclass(frozen=True)
class Line:
    """A column (axis 1) or a row (axis 0) of a matrix."""

    axis: int
    index: int


Step = Field | Element | Line


def steps_of(column: str) -> list[Step]:
    """The steps that a column's name is made of. Raises ValueError where it cannot be taken apart."""
    steps: list[Step] = []
    position = 0
    while position < len(column):
        if column[position] == "." and steps:
            position += 1
            if not (position < len(column) and column[position] not in ".[]"):
                raise ValueError("a name is missing after a dot")
        piece = _PIECE.match(column, position)
        if piece is None:
            raise ValueError("expected names with dots between, [k] for an element, [:, k] for a column of a matrix")
        position = piece.end()
        if piece["field"] is not None:
            steps.append(Field(piece["field"].strip()))
        elif piece["index"] is not None:
            steps.append(Element(int(piece["index"])))
        else:
            axis = 1 if piece["column"] is not None else 0
            steps.append(Line(axis, int(piece["column"] or piece["row"])))
    if not steps or not isinstance(steps[0], Field):
        raise ValueError("expected a name first")
    return steps


def root_of(column: str, found: Mapping[str, Any] | list[str]) -> str:
    """The top-level name that a column begins with: the whole of it where that is found, else what stands before dots and brackets."""
    if column in found:
        return column
    try:
        first = steps_of(column)[0]
    except ValueError:
        return column
    return first.name if isinstance(first, Field) else column


def inside(place: str, value: Any, steps: list[Step]) -> Any:
    """What the steps lead to from `value`: dictionaries, lists, and arrays of objects for MATLAB's cells and structures.

    Raises UserError, beginning with `place`, where a step leads nowhere.
    """
    for step in steps:
        value = _bare(value)
        value = _field(place, value, step.name) if isinstance(step, Field) else _part(place, value, step)
    return _bare(value)


def _bare(value: Any) -> Any:
    """The content of a cell or structure that stands alone in an array of its own."""
    while isinstance(value, np.ndarray) and value.dtype.kind == "O" and value.size == 1 and value.ndim:
        value = value.flat[0]
    return value


def _field(place: str, value: Any, name: str) -> Any:
    if isinstance(value, Mapping):
        if name in value:
            return value[name]
        raise UserError(f"{place}: no {name!r} in it{did_you_mean(name, map(str, value))}; found {_listed(value)}")
    if isinstance(value, np.ndarray) and value.dtype.names:  # records of NumPy: one a sample
        if name in value.dtype.names:
            return value[name]
        names = value.dtype.names
        raise UserError(f"{place}: no {name!r} in it{did_you_mean(name, names)}; found {_listed(names)}")
    if isinstance(value, list) and value and all(isinstance(entry, Mapping) for entry in value):
        return [_bare(entry.get(name)) for entry in value]  # records: one entry a sample
    if isinstance(value, np.ndarray) and value.size and isinstance(value.flat[0], Mapping):
        raise UserError(f"{place}: is an array of {value.size} structures; expected one, written like name[0].{name}")
    raise UserError(f"{place}: nothing has the field {name!r}; expected a structure before the dot")


def _part(place: str, value: Any, step: Element | Line) -> Any:
    if isinstance(step, Element):
        elements: Any = value.ravel(order="F") if isinstance(value, np.ndarray) else value
        elements = [value] if isinstance(value, Mapping) else elements  # a structure that stands alone
        if not isinstance(elements, np.ndarray | list):
            raise UserError(f"{place}: [{step.index}] is of nothing that has elements")
        if step.index >= len(elements):
            raise UserError(f"{place}: [{step.index}] is not among its {len(elements)} elements; the first is [0]")
        return elements[step.index]
    matrix = np.asarray(value)
    if matrix.ndim != 2:
        raise UserError(
            f"{place}: has the shape {matrix.shape}; expected a matrix where a column [:, k] or row [k, :] is asked for"
        )
    count = matrix.shape[step.axis]
    if step.index >= count:
        what = ("rows", "columns")[step.axis]
        raise UserError(f"{place}: {step.index} is not among its {count} {what}; the first is 0")
    return matrix[:, step.index] if step.axis else matrix[step.index]


def _listed(names: Any) -> str:
    listed = [str(name) for name in names]
    return ", ".join(listed[:30]) + (", …" if len(listed) > 30 else "") or "nothing"
