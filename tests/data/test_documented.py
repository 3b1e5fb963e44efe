"""`docs/data.md` says what the readers and cards understand."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from greybox_torch.data.card import Card
from greybox_torch.data.expression import _FUNCTIONS
from greybox_torch.data.readers import BUILT_IN

PAGE = (Path(__file__).parents[2] / "docs" / "data.md").read_text(encoding="utf-8")
SMALLEST, CHANNELS, TIME, MACHINE, FILES = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)


def test_every_suffix_is_in_the_table() -> None:
    rows = [line.split("|")[1:] for line in PAGE.splitlines() if line.startswith("| `")]
    found = {
        name for cells in rows for name in re.findall(r"\.\w+", cells[0] + (cells[1] if "jsonl" in cells[1] else ""))
    }
    assert found >= BUILT_IN


def test_every_function_of_expressions_is_named() -> None:
    assert set(_FUNCTIONS) <= set(re.findall(r"[a-z0-9]+", PAGE))


def test_the_cards_are_cards() -> None:
    smallest = tomllib.loads(SMALLEST)
    Card.model_validate(smallest)
    Card.model_validate(smallest | tomllib.loads(CHANNELS))
    Card.model_validate(smallest | tomllib.loads(FILES))
    timed = {key: value for key, value in smallest.items() if key != "sample_time"}
    Card.model_validate(timed | tomllib.loads(TIME))
    Card.model_validate(smallest | tomllib.loads(MACHINE))
