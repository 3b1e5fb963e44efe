"""Running the equations: that they give what is declared, the same each time, sample by sample; and whether they can be compiled."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from greybox_torch.checking.finding import Finding, Level
from greybox_torch.checking.source import Source
from greybox_torch.checking.tracing import Traced, traced
from greybox_torch.codegen.arrays import UnsupportedOperation
from greybox_torch.errors import UserError
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.check import EquationsError, check_equations, line_of, raised

_INSTEAD = {
    "linalg_inv_ex": "torch.linalg.solve(matrix, right_hand_side)",
    "_linalg_det": "the determinant written out",
    "copy": "torch.stack([…]) instead of writing into a matrix",
    "index_put": "torch.stack([…]) instead of writing into a matrix",
    "einsum": "matrix @ vector, or the sums written out",
}
_RAISES_NOTHING = (
    "equations that raise nothing, whatever values the states and inputs have, each a tensor with one number a sample"
)
_COMPILED = "+ - * / **, torch.where, sin, cos, tanh, exp, sqrt, abs, sign, minimum, maximum, clamp, stack, @, torch.linalg.solve"


def fails(model: GreyBoxModel, source: Source) -> Iterator[Finding]:
    """A finding where the equations raise, or do not return what is declared, or not twice the same."""
    try:
        check_equations(model)
    except EquationsError as error:
        yield told(error, source, _RAISES_NOTHING)
    except UserError as error:
        found, _, write = str(error).partition("; expected ")
        line = _line_of_return(str(error), source) or source.line
        yield Finding("error", "code", found, write or "equations that give one number a sample", source.file, line)


def told(error: EquationsError, source: Source, write: str, level: Level = "error") -> Finding:
    """The finding at the line where the equations went wrong, which may be in another file than the class is.

    Args:
        write: what to write instead, unless the error says it.
    """
    found, _, expected = error.found.partition("; expected ")
    file = source.file if error.file is None else Path(error.file)
    return Finding(level, "code", found, expected or write, file, error.line or source.line)


def _line_of_return(message: str, source: Source) -> int | None:
    """Where a method that a message says returned something returns it, the key that it names where it is written there."""
    told = re.search(r"\.(derivative|output)\(\) returned(?: '([^']+)')?", message)
    method = next((m for m in source.methods if told and m.name == told[1]), None)
    if told is None or method is None:
        return None
    returns = [node for node in ast.walk(method.tree) if isinstance(node, ast.Return)]
    keys = [key for node in returns if isinstance(node.value, ast.Dict) for key in node.value.keys]
    named = [key.lineno for key in keys if isinstance(key, ast.Constant) and key.value == told[2]]
    return next(iter([*named, *(node.lineno for node in returns)]), None)


def compiled(model: GreyBoxModel, source: Source) -> tuple[Traced | None, list[Finding]]:
    """The equations as an expression graph, or why there is none."""
    try:
        return traced(model, source.file), []
    except UnsupportedOperation as error:
        operation = str(error).split("'")[1].removeprefix("aten::") if "'" in str(error) else str(error)
        instead = _INSTEAD.get(operation, f"what is compiled: {_COMPILED}")
        found = (
            f"{error} has no compiled form: simulation takes a hundred times as long, and a diagnosis is out of reach"
        )
        return None, [Finding("warning", "code", found, instead, source.file, line_of(model, error))]
    except UserError as error:
        return None, [Finding("error", "code", str(error), f"functions of torch: {_COMPILED}", source.file)]
    except Exception as error:  # whatever the user's equations raise when they are handed symbols
        return None, [told(raised(model, error), source, f"functions of torch: {_COMPILED}")]
