"""`docs/howto/data.md` says what the readers and cards understand."""

from __future__ import annotations

import re
from pathlib import Path

from greybox_torch.data.expression import _FUNCTIONS
from greybox_torch.data.readers import BUILT_IN

PAGE = (Path(__file__).parents[2] / "docs" / "howto" / "data.md").read_text(encoding="utf-8")


def test_every_suffix_is_in_the_table() -> None:
    rows = [line.split("|")[1:] for line in PAGE.splitlines() if line.startswith("| `")]
    found = {
        name for cells in rows for name in re.findall(r"\.\w+", cells[0] + (cells[1] if "jsonl" in cells[1] else ""))
    }
    assert found >= BUILT_IN


def test_every_function_of_expressions_is_named() -> None:
    assert set(_FUNCTIONS) <= set(re.findall(r"[a-z0-9]+", PAGE))
