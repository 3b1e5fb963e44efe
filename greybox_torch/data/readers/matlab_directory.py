"""What a MATLAB file of version 5 to 7 holds, without reading it.

scipy's `whosmat` refuses a file with an object of a class anywhere in it; reading the variables that are asked for does not. And a
variable may declare more than the file holds, which has to be noticed before anything is allocated. The layout is that of "MAT-File
Format" (The MathWorks): elements with a tag of type and size, the newer ones compressed.
"""

from __future__ import annotations

import math
import struct
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from greybox_torch.data.readers.table import MOST_SAMPLES

_HEADER, _MATRIX, _COMPRESSED = 128, 14, 15
_SPARSE, _OPAQUE = 5, 17
_CONTAINERS = (1, 2, 3)  # cells, structures, objects: eight bytes at least for each element
_MOST_UNPACKED = 1032  # a byte of deflate gives at most as many
_PREFIX = 2048  # enough of an element for its flags, dimensions and name


@dataclass(frozen=True)
class Variable:
    """`samples` is what the variable declares, `most_samples` what its bytes could hold."""

    samples: int
    most_samples: int


def variables_of(path: Path) -> dict[str, Variable]:
    """The variables of the file at `path`, by name. Raises ValueError where it is damaged."""
    with path.open("rb") as file:
        size = file.seek(0, 2)
        file.seek(0)
        head = file.read(_HEADER)
        if len(head) == _HEADER and head[126:128] in (b"IM", b"MI") and 0 not in head[:4]:
            return _elements(file, size, "<" if head[126:128] == b"IM" else ">")
    return _version_4(path)


def _version_4(path: Path) -> dict[str, Variable]:
    import scipy.io

    size = path.stat().st_size
    return {name: Variable(math.prod(shape), size) for name, shape, _ in scipy.io.whosmat(path)}


def _elements(file: BinaryIO, size: int, order: str) -> dict[str, Variable]:
    found: dict[str, Variable] = {}
    position = _HEADER
    while position + 8 <= size:
        file.seek(position)
        kind, length = struct.unpack(order + "II", file.read(8))
        if position + 8 + length > size:
            raise ValueError(f"a variable declares {length} bytes, of which the file holds {size - position - 8}")
        if kind == _COMPRESSED:
            unpacked = zlib.decompressobj().decompress(file.read(min(length, _PREFIX)), _PREFIX)
            most, content = length * _MOST_UNPACKED, unpacked[8:]
            inner, declared = struct.unpack(order + "II", unpacked[:8])
            if declared > most:
                raise ValueError(f"a variable declares {declared} bytes, of which the file holds at most {most}")
            most = min(most, declared)
        else:
            inner, most, content = kind, length, file.read(min(length, _PREFIX))
        if inner == _MATRIX:
            name, variable = _variable(content, most, order)
            found.setdefault(name, variable)
        position += 8 + length
    return found


def _variable(content: bytes, most: int, order: str) -> tuple[str, Variable]:
    """Name and size from the flags, dimensions and name that a matrix begins with. `most` is how many bytes it may have."""
    _, flags_length = struct.unpack_from(order + "II", content)
    (flags,) = struct.unpack_from(order + "I", content, 8)
    position, kind, samples = 8 + flags_length, flags & 0xFF, 0
    if kind != _OPAQUE:  # an object of a class has no dimensions here
        dimensions, position = _data(content, position, order)
        samples = math.prod(struct.unpack(f"{order}{len(dimensions) // 4}i", dimensions[: len(dimensions) // 4 * 4]))
    name, position = _data(content, position, order)
    if kind == _SPARSE:  # zeros take no bytes
        return name.decode("latin-1"), Variable(samples, MOST_SAMPLES)
    if kind > _CONTAINERS[-1] and kind != _OPAQUE and position + 8 <= len(content):
        data, length = struct.unpack_from(order + "II", content, position)
        if data >> 16 == 0 and length > most:
            raise ValueError(
                f"{name.decode('latin-1')!r} declares {length} bytes, of which the file holds at most {most}"
            )
    return name.decode("latin-1"), Variable(samples, most // (8 if kind in _CONTAINERS else 1))


def _data(content: bytes, position: int, order: str) -> tuple[bytes, int]:
    """The data of one element, and where the next one begins. Up to four bytes stand in the tag itself."""
    kind, length = struct.unpack_from(order + "II", content, position)
    if kind >> 16:
        length = kind >> 16
        return content[position + 4 : position + 4 + length], position + 8
    return content[position + 8 : position + 8 + length], position + 8 + length + -length % 8
