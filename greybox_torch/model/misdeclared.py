"""Declarations that are none: a text in the place of a State, one State where a list is expected."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from greybox_torch.errors import UserError
from greybox_torch.model.declarations import Input, Output, Parameter, State

_KINDS: dict[str, tuple[type | None, str]] = {
    "states": (State, 'State("…", "unit")'),
    "inputs": (Input, 'Input("…", "unit")'),
    "outputs": (Output, 'Output("…", "unit")'),
    "parameters": (Parameter, 'Parameter("…", value, unit="…")'),
    "ports": (None, 'Body("…", speed="…")'),
}
"""What each list holds, and how one writes it; of ports, which may be of a kind of one's own, only that they have a name."""


def misdeclared(model: Any) -> Iterator[tuple[str, str]]:
    """What is declared in a way that no model can have, and what to write; of a class or an object of it."""
    for name, (kind, write) in _KINDS.items():
        declared = getattr(model, name)
        if name == "parameters" and callable(declared):  # torch's method: the list is kept by another name
            declared = model.declared_parameters
        if not isinstance(declared, Sequence) or isinstance(declared, str):
            yield f"'{name}' is {_told(declared)}, expected a list", f"{name} = [{write}]"
            continue
        for item in declared:
            if not isinstance(item, kind) if kind else isinstance(item, str) or not hasattr(item, "name"):
                told = write.replace("…", item, 1) if isinstance(item, str) else write
                yield f"'{name}' holds {_told(item)}, expected {told.partition('(')[0]}(…)", f"{name} = [{told}, …]"


def check_declarations(model: Any, title: str) -> None:
    """Raises UserError where a list of a model is none, is empty, holds what is no declaration, or names something twice."""
    for found, write in misdeclared(model):
        raise UserError(f"model {title}: {found}; write {write}")
    for kind in ("states", "outputs"):
        if not getattr(model, kind):
            raise UserError(f"model {title}: '{kind}' is empty, expected at least one")
    for kind in ("states", "inputs", "outputs", "declared_parameters", "ports"):
        names = [item.name for item in getattr(model, kind)]
        twice = sorted({n for n in names if names.count(n) > 1})
        if twice:
            raise UserError(f"model {title}: '{kind.removeprefix('declared_')}' names {', '.join(twice)} twice")


def _told(value: object) -> str:
    if isinstance(value, str | int | float | None):
        return repr(value)
    return f"{'an' if type(value).__name__[0] in 'AEIOU' else 'a'} {type(value).__name__}"
