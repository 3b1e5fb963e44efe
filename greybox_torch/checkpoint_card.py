"""The JSON card of a checkpoint: what it must say, and messages for one that does not."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from greybox_torch.errors import UserError, quoted
from greybox_torch.reading import parsed_json, read_bytes

SCHEMA = "greybox-checkpoint/1"

# What is expected, by the validator's type of error.
_EXPECTED = {
    "string_type": "a string",
    "bool_type": "true or false",
    "list_type": "a list",
    "dict_type": "an object",
    "missing": "this field",
}


class CheckpointCard(BaseModel):
    """The fields of a card, typed strictly. Unknown ones are left alone: what changes the meaning of a card changes its schema."""

    model_config = ConfigDict(strict=True, frozen=True)

    model: str
    title: str
    parameters: list[str]
    units: dict[str, str]
    effects: list[dict[str, Any]]
    free_starts: bool
    dataset: str
    figures: list[dict[str, Any]]
    versions: dict[str, str]
    created: str
    tensors: str
    own_weights: str = ""
    own_starts: str = ""


def read_checkpoint_card(path: Path) -> CheckpointCard:
    """The card at ``path``.

    Raises:
        UserError: it cannot be read, is not JSON, was written by a newer version, or a field is missing or not what it must be.
    """
    content = _content(path)
    schema = content.get("schema") if isinstance(content, dict) else None
    if schema != SCHEMA:
        newer = re.fullmatch(r"greybox-checkpoint/([2-9]|[1-9]\d+)", str(schema)) is not None
        advice = "; a newer greybox_torch has written it: update to read it" if newer else ""
        raise UserError(f'checkpoint {path}: "schema" is {quoted(schema)}, expected "{SCHEMA}"{advice}')
    try:
        card = CheckpointCard.model_validate(content)
    except ValidationError as error:
        problems = "; ".join(_problem(details) for details in error.errors())
        raise UserError(f"checkpoint {path}: {problems}") from None
    _check_names(path, card)
    return card


def _content(path: Path) -> Any:
    expected = "the card of a checkpoint"
    try:
        text = read_bytes(path, "a JSON card", "checkpoint").decode("utf-8")
    except UnicodeDecodeError as error:
        raise UserError(f"checkpoint {path}: not JSON: {error}; expected {expected}") from None
    return parsed_json(text, f"checkpoint {path}", expected)


def _problem(details: Any) -> str:
    place = ".".join(str(step) for step in details["loc"])
    expected = _EXPECTED.get(details["type"], details["msg"])
    if details["type"] == "missing":
        return f'"{place}" is missing; expected {expected}'
    return f'"{place}" is {quoted(details["input"])}, expected {expected}'


def _check_names(path: Path, card: CheckpointCard) -> None:
    """Every parameter once, and with its unit."""
    twice = _listed(name for name, count in Counter(card.parameters).items() if count > 1)
    if twice:
        raise UserError(f'checkpoint {path}: "parameters" names {twice} twice; expected each parameter once')
    without = _listed(name for name in card.parameters if name not in card.units)
    if without:
        raise UserError(f'checkpoint {path}: "units" lacks {without}; expected the unit of every parameter')
    known = set(card.parameters)
    beside = _listed(name for name in card.units if name not in known)
    if beside:
        raise UserError(f'checkpoint {path}: "units" has {beside}; expected the names under "parameters" alone')


def _listed(names: Iterable[str]) -> str:
    return ", ".join(names)
