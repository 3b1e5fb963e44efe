"""The options that all commands take, and where their output goes."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from greybox_torch.files import json_text

if TYPE_CHECKING:
    from rich.console import Console


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
        """Where to write results: --out, or results/<name of the folder that holds the data card>."""
        return self.out if self.out is not None else Path("results") / dataset.resolve().parent.name

    def console(self) -> Console:
        """What people read is printed here: standard output, or standard error where --json has taken the former."""
        from rich.console import Console

        return Console(stderr=self.json, highlight=False)

    def print_json(self, result: dict[str, Any]) -> None:
        """Prints the machine-readable result on standard output where --json asks for it."""
        if self.json:
            sys.stdout.write(json_text(result))
