"""The source text of a model's equations, so that findings can name a line."""

from __future__ import annotations

import ast
import inspect
import textwrap
from dataclasses import dataclass
from pathlib import Path

from greybox_torch.model import GreyBoxModel

KINDS = ("state", "input", "parameter", "port")
"""What the arguments of ``derivative`` hold, in their order; ``output`` may do without ports."""


@dataclass(frozen=True)
class Method:
    """``derivative`` or ``output`` as a syntax tree with the lines of its file; ``arguments`` says by name what an argument holds."""

    name: str
    tree: ast.FunctionDef
    file: Path
    arguments: dict[str, str]


@dataclass(frozen=True)
class Source:
    """The file of a class, the line that it begins in, and those of its equations whose text is to be had."""

    file: Path | None
    line: int | None
    methods: tuple[Method, ...] = ()

    def line_of(self, text: str, which: int = 1) -> int | None:
        """The first line of the class that holds ``text``, or another one, counted from one."""
        if self.file is None or self.line is None:
            return None
        try:
            lines = self.file.read_text(encoding="utf-8").splitlines()
        except (OSError, UnicodeDecodeError):
            return None
        found = [k for k, line in enumerate(lines[self.line - 1 :], self.line) if text in line]
        return found[which - 1] if len(found) >= which else None


def source_of(made: type[GreyBoxModel]) -> Source:
    """The source of a class; empty where it was typed into a console, which keeps no text."""
    try:
        file, (_, line) = inspect.getsourcefile(made), inspect.getsourcelines(made)
    except (OSError, TypeError):
        return Source(None, None)
    if file is None:
        return Source(None, None)
    methods = [method for name in ("derivative", "output") if (method := _method(made, name))]
    return Source(Path(file), line, tuple(methods))


def _method(made: type[GreyBoxModel], name: str) -> Method | None:
    function = inspect.unwrap(getattr(made, name))
    if function is getattr(GreyBoxModel, name):
        return None
    try:
        lines, first = inspect.getsourcelines(function)
        tree = ast.parse(textwrap.dedent("".join(lines))).body[0]
    except (OSError, TypeError, SyntaxError, IndexError):
        return None
    if not isinstance(tree, ast.FunctionDef):
        return None
    ast.increment_lineno(tree, first - 1)
    named = [a.arg for a in (*tree.args.posonlyargs, *tree.args.args)][1:]
    file = inspect.getsourcefile(function)
    return Method(name, tree, Path(file or ""), dict(zip(named, KINDS, strict=False)))
