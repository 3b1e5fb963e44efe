"""What all results have in common: they print, show themselves in a notebook, are saved whole or not at all, and turn into JSON."""

from __future__ import annotations

import json
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from io import StringIO
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console

from greybox_torch.files import json_text, remove_all, write_all

if TYPE_CHECKING:
    from matplotlib.figure import Figure

HERE = Path()
"""Where files are said to be, as long as it is not known where a result is saved: their names alone."""

HELD_OUT = 'No experiment has the role "validation": the last quarter of each is held out.'

_WIDE = 300


class Result(ABC):
    """A result of one of the public functions; it does not change."""

    @abstractmethod
    def content(self, folder: Path) -> dict[str, Any]:
        """What JSON tells of the result, if its files are in ``folder``. Numbers that are not finite become null."""

    @abstractmethod
    def show(self, console: Console) -> None:
        """Print the summary."""

    @abstractmethod
    def files(self, folder: Path) -> dict[Path, str | bytes]:
        """What is to be written to ``folder``, by path."""

    def earlier(self, folder: Path) -> Iterable[Path]:
        """Files that an earlier result of the same kind may have left in ``folder``; those that this one does not have are to go."""
        return ()

    @abstractmethod
    def plot(self) -> Figure:
        """The result as a figure."""

    @abstractmethod
    def _repr_html_(self) -> str:
        """What a notebook shows."""

    def to_json(self, folder: str | PathLike[str] = HERE) -> str:
        """The text that the command of the same name prints with --json.

        Args:
            folder: where :meth:`save` puts the files that the text names; by default it gives their names alone.
        """
        return json_text(self.content(Path(folder)))

    def to_dict(self, folder: str | PathLike[str] = HERE) -> dict[str, Any]:
        """:meth:`to_json` as a dictionary; numbers that are not finite are None."""
        return json.loads(self.to_json(folder))

    def save(self, folder: str | PathLike[str]) -> tuple[Path, ...]:
        """Write what the command of the same name writes: all of its files or none. Returns their paths.

        What an earlier result of the same kind left there and this one does not have is removed.

        Raises:
            UserError: the folder or a file cannot be written.
        """
        return self._written(Path(folder), self.files(Path(folder)))

    def _written(self, folder: Path, contents: Mapping[Path, str | bytes]) -> tuple[Path, ...]:
        write_all(contents)
        remove_all(path for path in self.earlier(folder) if path not in contents)
        return tuple(contents)

    def __str__(self) -> str:
        text = StringIO()
        self.show(Console(file=text, width=_WIDE, highlight=False))
        return "\n".join(line.rstrip() for line in text.getvalue().splitlines())
