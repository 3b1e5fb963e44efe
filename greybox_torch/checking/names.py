"""Names in the equations that the model does not declare, and states and outputs that the equations leave out."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence

from greybox_torch.checking.dimensions import per_second
from greybox_torch.checking.finding import Finding
from greybox_torch.checking.source import Method
from greybox_torch.errors import did_you_mean
from greybox_torch.model import GreyBoxModel, Signals

USUAL = ("x", "u", "p", "port")
"""What the arguments of ``derivative`` are called everywhere; ``output`` does without the last."""

_DECLARED_AS = {
    "state": 'State("{}", "…") in states',
    "input": 'Input("{}", "…") in inputs',
    "parameter": 'Parameter("{}", …) in parameters',
    "port": 'a port such as Body("{}", speed="…") in ports',
}


def declared_names(made: type[GreyBoxModel] | GreyBoxModel) -> dict[str, list[str]]:
    """The names of states, inputs, parameters and ports that the equations may use."""
    return {
        "state": [s.name for s in made.states],
        "input": [i.name for i in made.inputs],
        "parameter": [p.name for p in made.declared_parameters],
        "port": [port.name for port in made.ports],
    }


def unknown_names(method: Method, declared: Mapping[str, Sequence[str]]) -> Iterator[Finding]:
    """Findings for `x.name` and `x["name"]` where nothing of that name is declared."""
    for node in ast.walk(method.tree):
        used = _used(node, method.arguments)
        if used is None:
            continue
        argument, name = used
        kind = method.arguments[argument]
        if name in declared[kind] or hasattr(Signals, name):
            continue
        if kind == "port" and name.split(".")[0] in ("actuator", "sensor"):
            continue
        known = ", ".join(declared[kind]) or "none"
        hint = did_you_mean(name, declared[kind])
        yield Finding(
            "error",
            "name",
            f"{argument}.{name}: no {kind} has this name{hint}; declared are: {known}",
            f"{argument}.<a declared name>, or declare {_DECLARED_AS[kind].format(name)}",
            method.file,
            getattr(node, "lineno", None),
        )


def exchanged_arguments(method: Method, unknown: bool) -> Finding | None:
    """A finding where the usual arguments stand at unusual places, so that names in the equations look ``unknown``, or one is missing or
    one too many.
    """
    usual = USUAL[: len(USUAL) if method.name == "derivative" else -1]
    own = list(method.arguments)
    moved = any(name in usual and usual.index(name) != place for place, name in enumerate(own))
    if _can_be_called(method.tree, len(usual)) and not (moved and (unknown or len(own) < len(usual))):
        return None
    expected = f"{method.name}(self, {', '.join(usual)})"
    found = f"{method.name}({ast.unparse(method.tree.args)}): expected {expected}, in this order"
    return Finding("error", "declaration", found, f"def {expected}:", method.file, method.tree.lineno)


def _can_be_called(method: ast.FunctionDef, usual: int) -> bool:
    """Whether a method takes ``usual`` arguments beside itself; ``output`` may take the ports' forces as well."""
    arguments = method.args
    named = len(arguments.posonlyargs) + len(arguments.args) - 1
    handed = max(usual, min(named, len(USUAL)))
    enough = named >= handed or arguments.vararg is not None
    asked_for = named - len(arguments.defaults) <= handed and None not in arguments.kw_defaults
    return bool(method.decorator_list) or (enough and asked_for)  # what a decorator makes of it is not read here


def left_out(method: Method, names: Sequence[str], unit_of: Mapping[str, str]) -> Iterator[Finding]:
    """Findings for states without a rate, outputs that are not returned, and returned names that are neither.

    Only a dictionary that is written in the return statement is looked at.
    """
    kind, told = ("state", per_second) if method.name == "derivative" else ("output", str)
    for node in ast.walk(method.tree):
        if not (isinstance(node, ast.Return) and isinstance(node.value, ast.Dict)):
            continue
        keys = [key.value if isinstance(key, ast.Constant) else None for key in node.value.keys]
        if None in keys:  # a key that is computed, or another dictionary taken in
            continue
        for name in names:
            if name not in keys:
                unit = told(unit_of[name])
                yield Finding(
                    "error",
                    "name",
                    f"{kind} '{name}' is declared, but {method.name}() does not return it",
                    f'"{name}": … in what {method.name}() returns' + (f", in {unit}" if unit else ""),
                    method.file,
                    node.lineno,
                )
        for key, name in zip(node.value.keys, keys, strict=True):
            if name not in names:
                hint = did_you_mean(str(name), names)
                yield Finding(
                    "error",
                    "name",
                    f"{method.name}() returns '{name}', which is not a declared {kind}{hint}",
                    f"one of {', '.join(names)}, or declare the {kind}",
                    method.file,
                    getattr(key, "lineno", node.lineno),
                )


def _used(node: ast.AST, arguments: Mapping[str, str]) -> tuple[str, str] | None:
    """The argument and the name in `x.name` or `x["name"]`."""
    if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in arguments:
        return node.value.id, node.attr
    if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name) and node.value.id in arguments:
        key = node.slice
        if isinstance(key, ast.Constant) and isinstance(key.value, str):
            return node.value.id, key.value
    return None
