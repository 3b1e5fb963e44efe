"""Whether files that a command left are all there."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

WHOLE: dict[str, Callable[[bytes], bool]] = {
    ".json": lambda content: _reads(json.loads, content),
    ".jsonl": lambda content: all(_reads(json.loads, line) for line in content.splitlines()),
    ".html": lambda content: content.rstrip().endswith(b"</html>"),
    ".png": lambda content: content.endswith(b"IEND\xaeB`\x82"),
    ".fmu": lambda content: b"PK\x05\x06" in content[-100:],
    ".parquet": lambda content: content.endswith(b"PAR1"),
    ".safetensors": lambda content: len(content) > 8,
}
"""By suffix, whether a file is all there."""


def named_files(folder: Path) -> Iterator[Path]:
    """Files under names of their own, not the temporary ones."""
    return (file for file in folder.rglob("*") if file.is_file() and not file.name.startswith("."))


def is_whole(file: Path) -> bool:
    """Whether a file is all there, by its suffix. Only one of lines, which may be yet to come, is whole with nothing in it."""
    return WHOLE.get(file.suffix, bool)(file.read_bytes())


def _reads(read: Callable[[bytes], Any], content: bytes) -> bool:
    try:
        read(content)
    except ValueError:
        return False
    return True
