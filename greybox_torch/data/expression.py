"""A channel as a small expression of columns: "0.5 * (i1 - i2)", "Kt * current", 'hypot(col("v x"), col("v y"))', "unwrap(counts, 4096)".

Numbers, columns, + - * / **, and the functions below; nothing else is understood, and nothing is executed.
"""

from __future__ import annotations

import ast
import operator
import warnings
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.unwrapping import unwrapped

LONGEST = 500
_FUNCTIONS: dict[str, tuple[int, Callable[..., Any]]] = {
    **{
        name: (1, getattr(np, name))
        for name in ("sin", "cos", "tan", "arcsin", "arccos", "arctan", "sqrt", "exp", "log", "sign")
    },
    **{name: (1, getattr(np, name)) for name in ("abs", "radians", "degrees", "tanh")},
    **{name: (2, getattr(np, name)) for name in ("arctan2", "hypot", "minimum", "maximum")},
    "unwrap": (2, unwrapped),
}
_OPERATORS: dict[type, Callable[..., Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.USub: operator.neg,
    ast.UAdd: operator.pos,
}
_CONSTANTS = {"pi": np.pi}


@dataclass(frozen=True)
class Expression:
    """`text` as the user wrote it, and its tree; a tree of a column alone is the column's name."""

    text: str
    tree: ast.expr | str

    @classmethod
    def of_column(cls, column: str) -> Expression:
        """The column as it is, whatever its name looks like."""
        return cls(column, column)

    @cached_property
    def columns(self) -> tuple[str, ...]:
        """The columns that it needs."""
        return (self.tree,) if isinstance(self.tree, str) else tuple(dict.fromkeys(_columns(self.tree)))

    @cached_property
    def turns(self) -> dict[str, float]:
        """The columns of which it needs nothing but the turns added up, and a turn in the unit of each: 360 of
        ``unwrap(radians(heading), 2 * pi)``.
        """
        if isinstance(self.tree, str):
            return {}
        found, needed = {}, Counter(_columns(self.tree))
        for call in ast.walk(self.tree):
            if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "unwrap":
                inside = Counter(_columns(call.args[0]))
                slopes = {column: _slope(call.args[0], column) for column in inside if len(inside) == 1}
                period = float(_value(call.args[1], {}))
                found |= {c: period / abs(k) for c, k in slopes.items() if k and inside[c] == needed[c]}
        return found

    def of(self, columns: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
        """Its value (N,) where the columns (N,) are those given."""
        if isinstance(self.tree, str):
            return columns[self.tree]
        length = len(columns[self.columns[0]])
        with np.errstate(all="ignore"):
            return np.broadcast_to(np.asarray(_value(self.tree, columns), dtype=np.float64), (length,)).copy()


def turns_of(formulas: Iterable[Expression]) -> dict[str, float]:
    """The columns of which no formula needs anything but the turns added up, and a turn in the unit of each."""
    found: dict[str, set[float]] = {}
    for formula in formulas:
        for column in formula.columns:
            found.setdefault(column, set()).add(formula.turns.get(column, 0.0))
    return {column: min(turns) for column, turns in found.items() if len(turns) == 1 and min(turns) > 0.0}


def parse_expression(text: str) -> Expression:
    """The expression that `text` writes. Raises ValueError that says what is not understood."""
    if len(text) > LONGEST:
        raise ValueError(f"an expression of {len(text)} characters; expected at most {LONGEST}")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the parser's remarks, such as on a digit before a letter
            tree = ast.parse(text.strip(), mode="eval").body
        columns = _columns(tree)
    except SyntaxError as error:
        raise ValueError(f'"{text}" is not an expression: {error.msg}') from None
    except (RecursionError, MemoryError, OverflowError):
        raise ValueError("an expression that is nested too deeply, or has a number too large") from None
    if not columns:
        raise ValueError(
            f'"{text}" has no column; expected one at least; or, of a channel that has one value throughout, no expr and '
            "constants = { NAME = … } in every [[experiment]]"
        )
    return Expression(text, tree)


def _columns(tree: ast.expr) -> list[str]:
    """The columns in a tree. Raises ValueError where there is anything in it that is not understood."""
    match tree:
        case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
            float(number)
            return []
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATORS:
            return [*_columns(left), *_columns(right)]
        case ast.UnaryOp(op=op, operand=operand) if type(op) in _OPERATORS:
            return _columns(operand)
        case ast.Name(id=name):
            return [] if name in _CONSTANTS else [name]
        case ast.Attribute():
            return [_dotted(tree)]
        case ast.Call(func=ast.Name(id="col"), args=[ast.Constant(value=str() as name)], keywords=[]) if name:
            return [name]
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]) if name in _FUNCTIONS:
            if len(arguments) != _FUNCTIONS[name][0]:
                raise ValueError(f"{name} of {len(arguments)} values; expected {_FUNCTIONS[name][0]}")
            columns = [column for argument in arguments for column in _columns(argument)]
            if name == "unwrap":
                _check_period(arguments[1])
            return columns
    raise ValueError(
        f'"{ast.unparse(tree):.60}" is not understood; expected numbers, columns (those with other characters as col("…")), '
        f"+ - * / **, pi, and {', '.join(_FUNCTIONS)}"
    )


def _check_period(tree: ast.expr) -> None:
    """Raises ValueError where the second value of `unwrap` is not a number above zero."""
    with np.errstate(all="ignore"):
        usable = not _columns(tree) and 0.0 < float(_value(tree, {})) < np.inf
    if not usable:
        raise ValueError(
            f"unwrap by {ast.unparse(tree):.60}; expected the period as a number above zero, such as 4096 or 2 * pi"
        )


def _slope(tree: ast.expr, column: str) -> float:
    """How much it grows with a column, its only one; zero where it is no straight line over that."""
    with np.errstate(all="ignore"):
        first, middle, last = (float(_value(tree, {column: np.array(at)})) for at in (0.0, 1.0, 2.0))
    straight = np.isclose(last - middle, middle - first, rtol=1e-9, atol=0.0)
    return middle - first if straight else 0.0


def _dotted(tree: ast.expr) -> str:
    if isinstance(tree, ast.Attribute):
        return f"{_dotted(tree.value)}.{tree.attr}"
    if isinstance(tree, ast.Name):
        return tree.id
    raise ValueError(f'"{ast.unparse(tree):.60}" is not the name of a column; such a column is written col("…")')


def _value(tree: ast.expr, columns: Mapping[str, NDArray[np.float64]]) -> Any:
    match tree:
        case ast.Constant(value=number):
            return np.float64(number)  # type: ignore[arg-type]
        case ast.BinOp(left=left, op=op, right=right):
            return _OPERATORS[type(op)](_value(left, columns), _value(right, columns))
        case ast.UnaryOp(op=op, operand=operand):
            return _OPERATORS[type(op)](_value(operand, columns))
        case ast.Name(id=name):
            return np.float64(_CONSTANTS[name]) if name in _CONSTANTS else columns[name]
        case ast.Call(func=ast.Name(id="col"), args=[ast.Constant(value=name)]):
            return columns[str(name)]
        case ast.Call(func=ast.Name(id=name), args=arguments):
            return _FUNCTIONS[name][1](*(_value(argument, columns) for argument in arguments))
    return columns[_dotted(tree)]
