"""The one place where files that a user names are opened: regular files only, with one message for whatever is wrong.

A pipe would wait for ever, a device never ends, and a file that claims more than it holds must not make anyone allocate it.
"""

from __future__ import annotations

import json
import os
import re
import stat
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

from greybox_torch.errors import UserError

MOST_TEXT = 64 * 2**20
"""Most bytes of a card or another text that is read as a whole."""

_OF_BACKSLASHES = ("Unescaped '\\'", "Invalid hex value")
"""What is said of a path such as C:\\data in quotes."""

_DECIMAL_COMMA = re.compile(r"=\s*[+-]?\d+,\d")
"""A number with a decimal comma: TOML takes what follows for another key."""

_EXPERIMENTS = "Cannot declare ('experiment',) twice"
"""What is said of a second [experiment] of a card."""

_PLACE = re.compile(r"at line (\d+), column")
"""Where an error of TOML is said to be."""

_KINDS = (
    (stat.S_ISFIFO, "is a pipe"),
    (stat.S_ISCHR, "is a device"),
    (stat.S_ISBLK, "is a device"),
    (stat.S_ISSOCK, "is a socket"),
)


@contextmanager
def opened(path: Path, expected: str, kind: str = "") -> Iterator[BinaryIO]:
    """The regular file at `path`, open for reading.

    Args:
        expected: what should be there, to end a message with ("a data card, dataset.toml").
        kind: what the file is, where messages should begin with that ("checkpoint").

    Raises:
        UserError: no such file, a folder, a pipe, a device, a file that may not be read, a name that no file can have, or an error of
            the system while the block reads.
    """
    shown = f"{kind} {_shown(path)}".strip()
    try:
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    except FileNotFoundError:
        raise UserError(f"{shown}: no such file; expected {expected}") from None
    except OSError as error:
        raise UserError(f"{shown}: cannot be read: {error.strerror or error}; expected {expected}") from None
    except ValueError as error:  # a NUL character, or one that the file system's encoding lacks
        raise UserError(f"{shown}: cannot be the name of a file: {error}; expected {expected}") from None
    try:
        _check_regular(shown, os.fstat(descriptor).st_mode, expected)
        with os.fdopen(descriptor, "rb", closefd=False) as file:
            yield file
    except OSError as error:
        raise UserError(f"{shown}: cannot be read: {error.strerror or error}; expected {expected}") from None
    finally:
        os.close(descriptor)


def check_file(path: Path, expected: str, kind: str = "") -> int:
    """The size in bytes of the regular file at `path`. Raises UserError as :func:`opened` does."""
    with opened(path, expected, kind) as file:
        return os.fstat(file.fileno()).st_size


def read_bytes(path: Path, expected: str, kind: str = "", *, most: int = MOST_TEXT) -> bytes:
    """All of the file at `path`. Raises UserError as :func:`opened` does, and where it holds more than `most` bytes."""
    with opened(path, expected, kind) as file:
        size = os.fstat(file.fileno()).st_size  # what is asked for at once is allocated at once
        content = file.read(min(most, max(size, 2**20)) + 1)
    if len(content) > most:
        raise UserError(f"{kind} {path}".strip() + f": has more than {most // 2**20} MiB; expected {expected}")
    return content


def read_text(path: Path, expected: str) -> str:
    """All of the file at `path`, which is UTF-8. Raises UserError as :func:`read_bytes` does, and where it is not UTF-8."""
    content = read_bytes(path, expected)
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise UserError(f"{path}: not UTF-8 text but UTF-16; expected {expected}, saved as UTF-8")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise UserError(f"{path}, line {line}: not UTF-8 text; expected {expected}, saved as UTF-8") from None


def read_json(path: Path, expected: str) -> Any:
    """What the JSON file at `path` holds. Raises UserError as :func:`read_text` does, and where it is not JSON."""
    return parsed_json(read_text(path, expected), f"{path}", expected)


def parsed_json(text: str, place: str, expected: str) -> Any:
    """What a JSON text holds. Raises UserError, beginning with `place`, where it is not JSON."""
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:  # Python's own limit on the digits of an integer is a ValueError
        said = "nested too deeply" if isinstance(error, RecursionError) else error
        raise UserError(f"{place}: not JSON: {said}; expected {expected}") from None


def read_toml(path: Path, expected: str) -> dict[str, Any]:
    """The tables of the TOML file at `path`. Raises UserError as :func:`read_text` does, and where it is not TOML."""
    text = read_text(path, expected)
    try:
        return tomllib.loads(text.replace("\r\n", "\n").replace("\r", "\n"))
    except RecursionError:
        raise UserError(f"{path}: not valid TOML: nested too deeply; expected {expected}") from None
    except ValueError as error:  # TOMLDecodeError, and Python's own limit on the digits of an integer
        backslash = any(words in str(error) for words in _OF_BACKSLASHES)
        hint = "; write paths with / in the place of \\" if backslash else ""
        if str(error).startswith(_EXPERIMENTS):
            hint = "; expected double brackets, [[experiment]], for every recording"
        line = _line_of(str(error), text)
        if _DECIMAL_COMMA.search(line):
            hint = "; expected a decimal point, as in 0.02"
        raise UserError(f"{path}: not valid TOML: {error}{line}{hint}") from None


def _line_of(error: str, text: str) -> str:
    """The text of the line that an error of TOML names, to go on with; "" where it names none."""
    place = _PLACE.search(error)
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    line = lines[int(place[1]) - 1].strip() if place and int(place[1]) <= len(lines) else ""
    shown = "".join(c if c.isprintable() else ascii(c)[1:-1] for c in line)
    return f": {shown[:100]}{'…' if len(shown) > 100 else ''}" if shown else ""


def _check_regular(shown: str, mode: int, expected: str) -> None:
    if stat.S_ISDIR(mode):
        raise UserError(f"{shown}: cannot be read: Is a directory; expected {expected}")
    if not stat.S_ISREG(mode):
        kind = next((words for test, words in _KINDS if test(mode)), "is no regular file")
        raise UserError(f"{shown}: {kind}; expected {expected}, in a regular file")


def _shown(path: Path) -> str:
    """A path as text that a terminal can show, shortened where it is endless."""
    text = str(path)
    text = text if text.isprintable() else ascii(text)[1:-1]
    return text if len(text) <= 300 else f"{text[:150]}…{text[-100:]}"
