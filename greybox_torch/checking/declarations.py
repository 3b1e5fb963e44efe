"""What a class declares, looked at before an object of it is made."""

from __future__ import annotations

import keyword
from collections.abc import Iterator

from greybox_torch.checking.finding import Finding
from greybox_torch.checking.source import Source
from greybox_torch.model import GreyBoxModel, Signals
from greybox_torch.model.check import unknown_signals
from greybox_torch.model.misdeclared import misdeclared

_METHODS = {name for name in dir(Signals) if not name.startswith("_")}


def not_declared(made: type[GreyBoxModel], source: Source) -> Iterator[Finding]:
    """Findings for lists of a class that are none, or hold what is no declaration."""
    for found, write in misdeclared(made):
        line = source.line_of(f"{write.partition(' ')[0]} =", 1)
        yield Finding("error", "declaration", found, write, source.file, line or source.line)


def missing_methods(made: type[GreyBoxModel], source: Source) -> Iterator[Finding]:
    """Findings for equations that are not defined."""
    for name, arguments in (("derivative", "self, x, u, p, port"), ("output", "self, x, u, p")):
        if getattr(made, name) is getattr(GreyBoxModel, name):
            write = f"def {name}({arguments}): return {{…}}, a dictionary by name"
            yield Finding("error", "declaration", f"{name}() is not defined", write, source.file, source.line)


def declared_twice(made: type[GreyBoxModel], source: Source) -> Iterator[Finding]:
    """Findings for names that stand twice among the states, inputs, outputs, parameters or ports."""
    kinds = {"state": made.states, "input": made.inputs, "output": made.outputs, "parameter": made.declared_parameters}
    for kind, items in {**kinds, "port": made.ports}.items():
        names = [item.name for item in items]
        for name in dict.fromkeys(n for n in names if names.count(n) > 1):
            found = f"{kind} '{name}' is declared twice"
            line = source.line_of(f'{kind.capitalize()}("{name}"', 2) or source.line_of(f'"{name}"', 2)
            yield Finding("error", "declaration", found, "another name for one of the two", source.file, line)


def unusable_names(made: type[GreyBoxModel], source: Source) -> Iterator[Finding]:
    """Findings for names that equations cannot use as `x.name`."""
    for item in (*made.states, *made.inputs, *made.declared_parameters, *made.ports):
        line = source.line_of(f'"{item.name}"')
        if item.name in _METHODS:
            found = f"'{item.name}' is a method of what the equations are handed, so `.{item.name}` is not the value"
            yield Finding(
                "error", "declaration", found, f'another name, or ["{item.name}"] everywhere', source.file, line
            )
        elif not _an_attribute(item.name):
            found = f"'{item.name}' cannot be written as `.{item.name}` in Python"
            yield Finding("warning", "declaration", found, f'["{item.name}"], or another name', source.file, line)


def read_as(handed: str, name: str) -> str:
    """How equations read what is called ``name`` from what they are ``handed``: `u.voltage`, `u["su n"]`."""
    return f"{handed}.{name}" if _an_attribute(name) and name not in _METHODS else f'{handed}["{name}"]'


def _an_attribute(name: str) -> bool:
    return name.isidentifier() and not keyword.iskeyword(name)


def port_signals(made: type[GreyBoxModel], source: Source) -> Iterator[Finding]:
    """Findings for ports whose signal names no state."""
    for port, found, write in unknown_signals(made):
        yield Finding("error", "name", found, write, source.file, source.line_of(f'"{port.name}"'))


def no_ports(made: type[GreyBoxModel], source: Source) -> Iterator[Finding]:
    """A note where only inputs and outputs are places for what is missing."""
    if not made.ports:
        found = "ports is empty: missing physics is looked for at the inputs and outputs alone"
        write = 'ports = [Body("…", speed="…")], and port.… among the forces in derivative()'
        yield Finding("note", "declaration", found, write, source.file, source.line)
