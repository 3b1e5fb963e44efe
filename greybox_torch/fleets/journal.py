"""`fleet.jsonl` while a fleet is under way: a line for every row as it comes, for those who follow it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

from greybox_torch.errors import UserError
from greybox_torch.files import json_text, write_text
from greybox_torch.fleets.row import Row

JOURNAL = "fleet.jsonl"


def line(row: Row) -> str:
    """A row as a line of JSON in the strict sense: numbers that are not finite become null."""
    return json.dumps(json.loads(json_text(row.as_json())), ensure_ascii=False) + "\n"


def journal(folder: Path) -> Callable[[Row], None]:
    """Begin the file anew. What is returned adds a line for a row; the line is in the file when the call returns.

    Raises:
        UserError: it cannot be written, now or later.
    """
    path = folder / JOURNAL
    write_text(path, "")

    def add(row: Row) -> None:
        try:
            with path.open("a", encoding="utf-8") as file:
                file.write(line(row))
        except OSError as error:
            raise UserError(
                f"{path}: cannot be written: {error.strerror or error}; expected a place to write results"
            ) from None

    return add
