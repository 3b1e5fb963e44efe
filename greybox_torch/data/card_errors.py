"""Messages for cards that do not validate, in the words of the card instead of those of the validator."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import NoneType
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, ValidationError

from greybox_torch.errors import UserError, did_you_mean, quoted
from greybox_torch.files import toml_key

_Entry = TypeVar("_Entry", bound=BaseModel)

# What is expected, by the validator's type of error; {…} are filled from its context.
_EXPECTED = {
    "string_type": "text in quotes",
    "string_too_short": "text that is not empty",
    "float_type": "a number",
    "finite_number": "a finite number",
    "int_type": "a whole number",
    "bool_type": "true or false",
    "dict_type": "a table",
    "list_type": "a list",
    "greater_than_equal": "at least {ge}",
    "less_than_equal": "at most {le}",
    "too_short": "at least {min_length} entries",
    "too_long": "at most {max_length} entries",
    "literal_error": "{expected}",
}

# Places where the general words would not help.
_EXPECTED_AT = {
    ("channels",): "a table [channels] with an entry for every input and output",
    ("controller",): "a table [controller] with an entry for every input that a loop drives",
    ("experiment",): "one table [[experiment]], in double brackets, for every recording",
    ("rows",): "two whole numbers, [start, stop]",
    ("file",): "the name of a file, or a list of names",
    ("time",): 'the column of time stamps, or { column = "t", unit = "ms" }',
    ("hold",): '"zoh" (held until the next sample) or "foh" (straight lines between samples)',
    ("column",): "the name of a column, or its position from 1 on",
}


def describe(path: Path, error: ValidationError, content: dict[str, Any], card: type[BaseModel]) -> str:
    """One message: the file, and for everything that is wrong the field, what was found and what is expected."""
    problems = [_shown(_problem(details, content, card)) for details in error.errors()]
    if len(problems) == 1:
        return f"{path}: {problems[0]}"
    return f"{path}: {len(problems)} problems:\n" + "\n".join(f"  {problem}" for problem in problems)


def _shown(text: str) -> str:
    """A message that quotes names of the card, which may hold anything."""
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


def _problem(details: Any, content: dict[str, Any], card: type[BaseModel]) -> str:
    kind, location = details["type"], details["loc"]
    if kind == "extra_forbidden":
        allowed = _allowed_keys(card, location[:-1])
        if _is_constant(details, content):
            return f"{_at(location[:-1], content)}unknown key {quoted(location[-1])}; expected {_constant(location[1], details['input'])}"
        hint = did_you_mean(location[-1], allowed)
        return _at(location[:-1], content) + f'unknown key "{location[-1]}"{hint}; expected {", ".join(allowed)}'
    expected = _EXPECTED_AT.get(location[-1:]) or _EXPECTED.get(kind, "").format(**details.get("ctx", {}))
    if kind == "model_type" and not expected:
        expected = f"a table, like {_table_of(location, details['input'])}"
    if kind == "missing":
        return (
            _at(location[:-1], content)
            + f'"{location[-1]}" is missing'
            + (f"; expected {expected}" if expected else "")
        )
    place = _at(location, content)
    if kind == "value_error":
        return place + str(details["ctx"]["error"])
    return place + f"found {quoted(details['input'])}, expected {expected or details['msg']}"


def _table_of(location: Sequence[str | int], found: Any) -> str:
    """A table for what stands alone, with the key that its value has there."""
    match location:
        case ["channels", name] if isinstance(found, float):
            return _constant(name, found)
        case ["channels", _] if isinstance(found, str | int):
            return f'{{ column = {quoted(found)}, unit = "…" }}'
        case ["model", "parameters" | "initial", _] if isinstance(found, int | float):
            return f"{{ value = {quoted(found)} }}"
        case ["model", "initial", _]:  # "measured" is an entry of the state, in the model
            return '{ value = 0.0 }; to begin as measured, initial="measured" of the State in the model'
        case ["model", "parameters", _]:
            return "{ value = 1.0 }"
    return "{ key = value }"


def _is_constant(details: Any, content: dict[str, Any]) -> bool:
    """Whether a channel without a column has a number, whatever its key: `rope = { value = 0.9 }`."""
    match details["loc"]:
        case ["channels", str(name), _] if type(details["input"]) in (int, float):
            return not {"column", "expr"} & set(content["channels"][name])
    return False


def _constant(channel: str | int, value: float) -> str:
    return f'{{ unit = "…" }} alone, and constants = {{ {toml_key(str(channel))} = {quoted(value)} }} in every [[experiment]]'


def _at(location: Sequence[str | int], content: dict[str, Any]) -> str:
    """The place in the card's own notation, with a colon after it; nothing for the top of the card."""
    match list(location):
        case []:
            return ""
        case ["channels", *rest]:
            parts = ["[channels]", *rest]
        case ["controller", *rest]:
            parts = ["[controller]", *rest]
        case ["experiment", int(index), *rest]:
            entry = content["experiment"][index]
            name = entry.get("name") if isinstance(entry, dict) else None
            parts = [f"[[experiment]] {index + 1}" + (f' "{name}"' if name else ""), *rest]
        case ["model", "parameters" | "initial" as table, *rest]:
            parts = [f"[model.{table}]", *rest]
        case ["model", *rest]:
            parts = ["[model]", *rest]
        case rest:
            parts = rest
    return ", ".join(str(part) for part in parts) + ": "


def _allowed_keys(card: type[BaseModel], location: Sequence[str | int]) -> list[str]:
    """The keys of the table at this location, found by walking the types of the card's fields."""
    table: Any = card
    for step in location:
        inner = get_args(table)  # of dict[str, Entry] or list[Entry]; an Entry itself has none
        table = inner[-1] if inner else _without_none(table.model_fields[str(step)].annotation)
    return list(table.model_fields)


def _without_none(kind: Any) -> Any:
    """Entry for Entry | None."""
    kinds = get_args(kind)
    return next(k for k in kinds if k is not NoneType) if NoneType in kinds else kind


def entries(
    argument: str, given: Mapping[str, Any] | None, entry: type[_Entry], of: str = "DataSet"
) -> dict[str, _Entry]:
    """Entries of the card given as an argument: each as it is on the card, as a table of it, or as its value alone.

    Raises UserError naming the argument, what it belongs to, and the entry where one does not validate.
    """
    held: dict[str, _Entry] = {}
    for name, what in (given or {}).items():
        try:
            held[name] = what if isinstance(what, entry) else entry.model_validate(_table(what))
        except ValidationError as error:
            problems = (_problem(details, {}, entry) for details in error.errors())
            raise UserError(f"{of}, {argument}, {name}: {'; '.join(problems)}") from None
    return held


def _table(what: Any) -> Any:
    return dict(what) if isinstance(what, Mapping) else {"value": what}
