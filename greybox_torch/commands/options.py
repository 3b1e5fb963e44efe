"""The options that all commands take, and how every command ends: its result saved, printed, and told as JSON."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, redirect_stdout
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from greybox_torch.files import absolute

if TYPE_CHECKING:
    from rich.console import Console

    from greybox_torch.api.result import Result


USUAL = "dataset"
"""The name of a card that is the only one in its folder."""

_STANDARD_OUTPUT: ContextVar[TextIO | None] = ContextVar("standard output", default=None)


@contextmanager
def json_alone() -> Iterator[None]:
    """While the block runs, standard output is for the JSON of `print_json`: what a model prints goes to standard error."""
    before = _STANDARD_OUTPUT.set(sys.stdout)
    try:
        with redirect_stdout(sys.stderr):
            yield
    finally:
        _STANDARD_OUTPUT.reset(before)


@dataclass(frozen=True)
class Options:
    """`model` and `out` are None where the user leaves the choice to the data set."""

    model: str | None = None
    out: Path | None = None
    seed: int = 0
    device: str = "cpu"
    json: bool = False
    precision: str = "double"

    def folder(self, dataset: Path) -> Path:
        """Where to write results: --out, else results/<folder of the card>, with the card's name behind it unless that is dataset.toml."""
        if self.out is not None:
            return self.out
        card = absolute(dataset)
        own = "" if card.stem == USUAL else f"-{card.stem}"
        return Path("results") / f"{card.parent.name}{own}"

    def finish(self, result: Result, folder: Path, written: Sequence[Path] | None = None) -> None:
        """Saves the result, all of it or nothing, unless its files are ``written`` already, and prints it."""
        written = result.save(folder) if written is None else written
        console = self.console()
        result.show(console)
        self.print_written(console, folder, _listed(folder, written))
        self.print_json(result.to_json(folder))

    def console(self) -> Console:
        """What people read is printed here: standard output, or standard error where --json has taken the former."""
        from rich.console import Console

        class Output(Console):
            def on_broken_pipe(self) -> None:
                raise  # rich would end with 1; see `Commands`

        return Output(stderr=self.json, highlight=False)

    def print_written(self, console: Console, folder: Path, names: list[str]) -> None:
        """Says where the files are."""
        from rich.text import Text

        console.print(Text(f"Written to {folder}: {', '.join(names)}"), soft_wrap=True)

    def print_json(self, text: str) -> None:
        """Prints the machine-readable result on standard output where --json asks for it."""
        if self.json:
            (_STANDARD_OUTPUT.get() or sys.stdout).write(text)


def _listed(folder: Path, written: Sequence[Path]) -> list[str]:
    """The names of files, and those of folders with how many files are in them."""
    parts = [path.relative_to(folder).parts for path in written]
    inside = Counter(part[0] for part in parts if len(part) > 1)
    return [*(part[0] for part in parts if len(part) == 1), *(f"{n}/ ({count} files)" for n, count in inside.items())]
