"""Writing whole or not at all, for a proof that may be killed at any moment. (Not by the package's own writers: nothing is shared.)"""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path
from typing import Any


def write_bytes(path: Path, content: bytes, mode: int = 0o644) -> None:
    """Into a file beside, flushed to the disk, then renamed."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.name}.partial")
    handle = os.open(partial, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, mode)
    with os.fdopen(handle, "wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    partial.replace(path)


def write_json(path: Path, value: Any, mode: int = 0o644) -> None:
    write_bytes(path, canonical(value, indent=1) + b"\n", mode)


def canonical(value: Any, indent: int | None = None) -> bytes:
    """JSON with sorted keys: equal values have equal bytes. Numbers that are not finite are refused."""
    return json.dumps(value, sort_keys=True, indent=indent, ensure_ascii=False, allow_nan=False).encode()


def sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
