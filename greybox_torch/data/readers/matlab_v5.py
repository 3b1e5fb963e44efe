"""MATLAB files of version 5 to 7: what they hold, and the variables that are asked for.

scipy's reader refuses a file with an object of a class anywhere in it when it lists the names, and damaged files make it crash with
the whole process. The format is plain enough to be read here, with every length checked against the bytes that are there: "MAT-File
Format" (The MathWorks), elements with a tag of type and size, the newer ones compressed.
"""

from __future__ import annotations

import math
import struct
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.readers.table import MOST_SAMPLES, MOST_UNPACKED
from greybox_torch.reading import read_bytes

_HEADER, _MATRIX, _COMPRESSED = 128, 14, 15
_CELL, _STRUCT, _OBJECT, _CHAR, _SPARSE, _FUNCTION, _OPAQUE = 1, 2, 3, 4, 5, 16, 17
_MOST_BYTES = 8 * MOST_SAMPLES
_PREFIX = 2048  # enough of an element for its flags, dimensions and name
_NUMBERS = {
    1: "i1",
    2: "u1",
    3: "i2",
    4: "u2",
    5: "i4",
    6: "u4",
    7: "f4",
    9: "f8",
    12: "i8",
    13: "u8",
    16: "u1",
    17: "u2",
    18: "u4",
}


class Other:
    """What is no number, structure or cell: an object of a class, a function."""


@dataclass(frozen=True)
class Variables:
    """The variables of a file by name: where each begins in `content`, with its tag."""

    content: memoryview
    order: str
    places: dict[str, int]

    def value(self, name: str) -> Any:
        """The variable's value: an array, a dictionary for a structure, an array of objects for cells and several structures."""
        return _Element(self.content, self.places[name], len(self.content), self.order).value()


def is_version_5(path: Path) -> bool:
    """Whether the file begins as one of version 5 to 7 does."""
    with path.open("rb") as file:
        head = file.read(_HEADER)
    return len(head) == _HEADER and head[126:128] in (b"IM", b"MI") and 0 not in head[:4]


def variables_of(path: Path) -> Variables:
    """The variables of the file at `path`. Raises ValueError and struct.error where it is damaged."""
    content = memoryview(read_bytes(path, "a recording", most=_MOST_BYTES))
    order = "<" if bytes(content[126:128]) == b"IM" else ">"
    places: dict[str, int] = {}
    position = _HEADER
    while position + 8 <= len(content):
        element = _Element(content, position, len(content), order)
        name = element.name()
        if name is not None:
            places.setdefault(name, position)
        position = element.end
    return Variables(content, order, places)


class _Element:
    """An element with its tag at `position`, in bytes that end at `stop`."""

    def __init__(self, content: memoryview, position: int, stop: int, order: str) -> None:
        if position + 8 > stop:
            raise ValueError("ends in the middle of a variable")
        self.order = order
        self.kind, length = struct.unpack_from(order + "II", content, position)
        begin = position + 8
        if self.kind >> 16:  # up to four bytes stand in the tag itself
            length, self.kind, begin = self.kind >> 16, self.kind & 0xFFFF, position + 4
            self.end = position + 8
        else:
            self.end = begin + length + (0 if self.kind == _COMPRESSED else -length % 8)
        if begin + length > stop:
            raise ValueError(f"declares {length} bytes where {max(stop - begin, 0)} are left")
        self.data = content[begin : begin + length]

    def matrix(self, most: int | None = None) -> _Element:
        """The element itself, or the one that is packed in it, of which the first `most` bytes may do.

        Raises ValueError and zlib.error where what is packed is damaged, which only the whole of it tells for sure.
        """
        if self.kind != _COMPRESSED:
            return self
        packed = self.data if most is None else self.data[:most]
        unpacker = zlib.decompressobj()
        head = unpacker.decompress(packed, 8)
        if len(head) < 8:
            raise ValueError("ends in the middle of a variable")
        _, declared = struct.unpack(self.order + "II", head)
        if declared > min(len(self.data) * MOST_UNPACKED, _MOST_BYTES):
            raise ValueError(f"declares {declared} bytes, more than its {len(self.data)} can be unpacked to")
        wanted = declared if most is None else min(declared, most)
        rest = unpacker.decompress(unpacker.unconsumed_tail, wanted) if wanted else b""
        if most is None and (unpacker.decompress(unpacker.unconsumed_tail, 1) or not unpacker.eof):
            raise ValueError(
                "unpacks to another length than it declares"
            )  # zlib compares its checksum at the end alone
        tag = struct.pack(self.order + "II", struct.unpack(self.order + "I", head[:4])[0], len(rest))
        return _Element(memoryview(tag + rest), 0, 8 + len(rest), self.order)

    def name(self) -> str | None:
        """The variable's name; None where this is no variable."""
        matrix = self.matrix(_PREFIX)
        if matrix.kind != _MATRIX or not len(matrix.data):
            return None
        flags, rest = matrix.parts(2)
        if _class(flags, self.order) == _OPAQUE:  # which has its name in the place of dimensions
            return bytes(rest.data).decode("latin-1")
        return bytes(matrix.parts(3)[2].data).decode("latin-1")

    def parts(self, count: int) -> list[_Element]:
        """The first `count` elements in this one."""
        found, position = [], 0
        for _ in range(count):
            found.append(_Element(self.data, position, len(self.data), self.order))
            position = found[-1].end
        return found

    def numbers(self) -> NDArray:
        """The numbers of an element that holds nothing else."""
        if self.kind not in _NUMBERS:
            raise ValueError(f"numbers of the unknown type {self.kind}")
        dtype = np.dtype(self.order + _NUMBERS[self.kind])
        return np.frombuffer(self.data, dtype, len(self.data) // dtype.itemsize)

    def value(self) -> Any:
        """What the variable in this element holds."""
        matrix = self.matrix()
        if matrix.kind != _MATRIX:
            raise ValueError(f"an element of type {matrix.kind} in the place of a variable")
        if not len(matrix.data):
            return np.zeros((0, 0))
        flags = matrix.parts(1)[0]
        kind = _class(flags, self.order)
        if kind in (_OPAQUE, _FUNCTION):
            return np.array(Other(), dtype=object)
        _, dimensions, _, *_ = head = matrix.parts(3)
        shape = tuple(int(n) for n in dimensions.numbers())
        count = math.prod(shape)
        if len(shape) < 2 or any(n < 0 for n in shape):
            raise ValueError(f"dimensions {shape}")
        position = head[-1].end
        if kind in (_CELL, _STRUCT, _OBJECT):
            return matrix.members(kind, shape, count, position)
        if kind == _SPARSE:
            return matrix.sparse(shape, count, position)
        return matrix.array(kind, bool(flags.data[1 if self.order == "<" else 2] & 8), shape, count, position)

    def array(self, kind: int, is_complex: bool, shape: tuple[int, ...], count: int, position: int) -> NDArray:
        real = _Element(self.data, position, len(self.data), self.order)
        if kind == _CHAR:
            return np.array(["text"])
        values = real.numbers()
        if len(values) != count:
            raise ValueError(f"declares {count} numbers and holds {len(values)}")
        if is_complex:
            imaginary = _Element(self.data, real.end, len(self.data), self.order).numbers()
            if len(imaginary) != count:
                raise ValueError(f"declares {count} numbers and holds {len(imaginary)}")
            values = values + 1j * imaginary
        return values.reshape(shape, order="F")

    def sparse(self, shape: tuple[int, ...], count: int, position: int) -> NDArray:
        if len(shape) != 2 or count > MOST_SAMPLES // 10:
            raise ValueError(f"a sparse matrix of {count} numbers")
        rows, starts = _two(self.data, position, self.order)
        values = _Element(self.data, starts.end, len(self.data), self.order).numbers()
        begin = starts.numbers().astype(np.int64)
        row = rows.numbers()[: len(values)].astype(np.int64)
        column = np.repeat(np.arange(shape[1]), np.diff(begin))
        if len(begin) != shape[1] + 1 or len(row) != len(values) or len(column) > len(values) or (row < 0).any():
            raise ValueError("a sparse matrix whose parts do not fit")
        full = np.zeros(shape)
        full[row[: len(column)], column] = values[: len(column)]
        return full

    def members(self, kind: int, shape: tuple[int, ...], count: int, position: int) -> Any:
        """Cells as an array of objects; a structure as a dictionary, several as an array of them."""
        names = [""]
        if kind == _OBJECT:  # the name of its class
            position = _Element(self.data, position, len(self.data), self.order).end
        if kind != _CELL:
            width, fields = _two(self.data, position, self.order)
            position, each = fields.end, max(int(width.numbers()[0]), 1)
            text = bytes(fields.data)
            names = [text[k : k + each].split(b"\0")[0].decode("latin-1") for k in range(0, len(text), each)]
        if count * len(names) * 8 > len(self.data) - position:
            raise ValueError(f"declares {count} elements in {len(self.data)} bytes")
        made = np.empty(count, dtype=object)
        for k in range(count):
            values = []
            for _ in names:
                element = _Element(self.data, position, len(self.data), self.order)
                values.append(element.value())
                position = element.end
            made[k] = values[0] if kind == _CELL else dict(zip(names, values, strict=True))
        return made[0] if kind != _CELL and count == 1 else made.reshape(shape, order="F")


def _class(flags: _Element, order: str) -> int:
    if len(flags.data) < 8:
        raise ValueError("a variable without flags")
    return struct.unpack_from(order + "I", flags.data)[0] & 0xFF


def _two(data: memoryview, position: int, order: str) -> tuple[_Element, _Element]:
    first = _Element(data, position, len(data), order)
    return first, _Element(data, first.end, len(data), order)
