"""Writing results so that nothing is ever half-written: into a temporary file beside the place, then renamed."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

from greybox_torch.errors import UserError


def absolute(path: Path) -> Path:
    """`path` from the root of the file system on, links followed as far as they lead anywhere."""
    try:
        return path.resolve()
    except (OSError, RuntimeError, ValueError):  # a loop of links, a name that no file can have
        return path.absolute()


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A temporary path to write to, in the folder of `path`, which replaces `path` once the block ends without an
    error.

    The folder is made where it is missing. The temporary name keeps the suffix, as many writers go by it. Raises
    UserError where the folder or the file cannot be written.
    """
    with _beside(path) as temporary:
        yield temporary
        temporary.replace(path)


@contextmanager
def _beside(path: Path) -> Iterator[Path]:
    """A temporary path in the folder of `path`, gone once the block ends. Raises UserError as :func:`replacing` does."""
    if "\0" in str(path):
        raise UserError(f"{str(path)!r}: cannot be written: holds a NUL character; expected a place to write results")
    temporary = path.with_name(f".{path.stem}.{os.getpid()}.partial{path.suffix}")
    try:
        with _told(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            yield temporary
    finally:
        with suppress(OSError):  # a name that is too long for a file was none from the start
            temporary.unlink(missing_ok=True)


@contextmanager
def _told(path: Path) -> Iterator[None]:
    """Turns what the system raises in the block into a UserError about `path`."""
    try:
        yield
    except OSError as error:
        raise UserError(
            f"{path}: cannot be written: {error.strerror or error}; expected a place to write results"
        ) from error


def _is_folder(path: Path) -> bool:
    try:
        return path.is_dir()
    except OSError:  # a name that is too long; writing will say so
        return False


def write_text(path: Path, text: str) -> None:
    """Writes `text` to `path` as UTF-8, whole or not at all. Raises UserError where it cannot be written."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def write_new(path: Path, text: str) -> None:
    """Writes `text` to `path` as UTF-8, whole or not at all. Raises UserError where there is something already, or it cannot be written."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
        try:
            os.link(temporary, path)  # fails where the name is taken, in whatever moment it was
        except FileExistsError:
            raise _taken(path) from None
        except OSError:  # a file system without links
            if path.exists():
                raise _taken(path) from None


def _taken(path: Path) -> UserError:
    return UserError(f"{path}: is there already and is not overwritten; expected a new name, or --out")


def write_all(contents: Mapping[Path, str | bytes]) -> None:
    """Writes files that belong together. Text is encoded as UTF-8.

    All are written beside their places before the first takes its place, and they take them in the order given. So where one cannot be
    written, none is; and whenever the process is killed, the last one is new only if all others are.

    Raises UserError where one cannot be written. Where the system then refuses a file its place, those before it have theirs.
    """
    with ExitStack() as together:
        written: dict[Path, Path] = {}
        for path, content in contents.items():
            if _is_folder(path):
                raise UserError(f"{path}: cannot be written: it is a folder; expected a place for a file")
            written[path] = together.enter_context(_beside(path))
            written[path].write_bytes(content.encode() if isinstance(content, str) else content)
        for path, temporary in written.items():
            with _told(path):
                temporary.replace(path)


def remove_all(paths: Iterable[Path]) -> None:
    """Removes files that no longer belong to what lies beside them, as far as the system lets them go, and folders that are empty then."""
    for path in paths:
        with suppress(OSError):
            path.unlink()
            path.parent.rmdir()  # only where nothing is left in it


def json_text(result: Any) -> str:
    """`result` as JSON in the strict sense: numbers that are not finite, which JSON does not know, become null."""
    return json.dumps(_finite(result), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def toml_text(value: str) -> str:
    """A string of TOML, which is one of JSON but for the character DEL."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def toml_key(name: str) -> str:
    """A key of TOML, quoted where it has to be."""
    return name if name.replace("_", "").isascii() and name.replace("_", "").isalnum() else toml_text(name)
