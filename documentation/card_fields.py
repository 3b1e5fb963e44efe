"""The page of everything that a card may say, written from the classes that read it."""

from __future__ import annotations

import inspect
from typing import Any, get_args

from documentation.tables import table
from greybox_torch.data.card import Card, InitialEntry, ParameterEntry
from greybox_torch.data.card_channels import ChannelEntry, Entry, ExperimentEntry, FileClock, OwnColumn, TimeEntry
from greybox_torch.data.card_controller import LoopEntry

TABLES: tuple[tuple[str, type[Entry]], ...] = (
    ("At the top", Card),
    ("`time = { … }`", TimeEntry),
    ("`[channels]`: `NAME = { … }`", ChannelEntry),
    ("`[[experiment]]`", ExperimentEntry),
    ("`columns = { NAME = { … } }` of an experiment", OwnColumn),
    ("`clocks = { FILE = { … } }` of an experiment", FileClock),
    ("`[controller]`: `INPUT = { … }`", LoopEntry),
    ("`[model.parameters]`: `NAME = { … }`", ParameterEntry),
    ("`[model.initial]`: `STATE = { … }`", InitialEntry),
)


def page() -> str:
    """The page in Markdown."""
    lines = [
        "# The card's fields",
        "",
        "Written from the program. A key that is unknown is refused, with the nearest known one. [Examples](../howto/data.md).",
    ]
    for title, entry in TABLES:
        told = inspect.cleandoc(entry.__doc__ or "")
        rows = [(f"`{name}`", _kind(name, field), _default(field)) for name, field in entry.model_fields.items()]
        lines += ["", f"## {title}", "", told, "", *table(("key", "value", "where it is left out"), rows)]
    return "\n".join(lines) + "\n"


KINDS = {float: "number", int: "whole number", str: "text", bool: "true or false", list: "list", dict: "table"}
TABLE_OF = {"channels": "a table for each", "experiment": "a list of tables", "model": "a table"}


def _kind(name: str, field: Any) -> str:
    if name in TABLE_OF:
        return TABLE_OF[name]
    found: list[str] = []
    _collect(field.annotation, found)
    return " or ".join(dict.fromkeys(found))


def _collect(annotation: Any, found: list[str]) -> None:
    """What an annotation allows, in words."""
    origin, inside = getattr(annotation, "__origin__", None), get_args(annotation)
    if annotation in KINDS or origin in KINDS:
        found.append(KINDS[annotation if annotation in KINDS else origin])
    elif inside and all(isinstance(value, str) for value in inside):
        found.extend(f'`"{value}"`' for value in inside)
    elif inside:
        for each in inside[:1] if hasattr(annotation, "__metadata__") else inside:
            _collect(each, found)
    elif annotation is not type(None):
        found.append(getattr(annotation, "__name__", str(annotation)).removesuffix("Entry").lower())


def _default(field: Any) -> str:
    if field.is_required():
        return "**required**"
    default = field.get_default(call_default_factory=True)
    if default is None or default in ({}, "") or isinstance(default, Entry):
        return ""
    return f'`"{default}"`' if isinstance(default, str) else f"`{default}`"
