"""A scalar expression graph with common-subexpression elimination, the form in which a traced model is held."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable
from typing import NamedTuple

ARITHMETIC = {"add": "+", "sub": "-", "mul": "*", "div": "/"}
COMPARISONS = {"lt": "<", "le": "<=", "gt": ">", "ge": ">=", "eq": "==", "ne": "!="}
LOGIC = {"and": "&", "or": "|"}
FUNCTIONS = (
    "exp", "log", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh",
    "floor", "abs", "sign", "erf", "log1p", "expm1",
)  # fmt: skip
BOOLEAN = frozenset({*COMPARISONS, *LOGIC, "not"})


class Node(NamedTuple):
    """One operation: its name, its arguments (indices of earlier nodes), and the value of a constant or index of a leaf."""

    operation: str
    arguments: tuple[int, ...] = ()
    value: float = 0.0
    leaf: str = ""


class Graph:
    """Nodes in order of creation, so that arguments always come before their use. Equal nodes are one node.

    A screen's graph has tens of thousands of nodes and is made anew for every model, so that making one has to be quick.
    """

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self._index: dict[tuple[object, ...], int] = {}
        self._values: list[float | None] = []  # of constants, None for all other nodes
        self._depending: dict[frozenset[str], list[bool]] = {}

    def constant(self, value: float) -> int:
        return self._intern("constant", value=float(value))

    def leaf(self, kind: str, index: int) -> int:
        """A variable: ``x``, ``u`` or ``p`` with its position."""
        return self._intern("leaf", value=float(index), leaf=kind)

    def apply(self, operation: str, *arguments: int) -> int:
        """The node of ``operation`` on ``arguments``, folded and simplified where that is exact."""
        values = self._values
        known = [values[a] for a in arguments]
        unknown = known.count(None)
        if unknown == len(known) and operation not in ("neg", "where"):  # by far the most
            return self._intern(operation, arguments)
        if unknown == 0:
            folded = _fold(operation, [v for v in known if v is not None])
            if folded is not None:
                return self.constant(folded)
        simple = self._simplify(operation, arguments, known)
        return simple if simple is not None else self._intern(operation, arguments)

    def power(self, base: int, exponent: float) -> int:
        """``base`` to a constant power, by multiplication where the exponent is a small integer."""
        if exponent == 0.5:
            return self.apply("sqrt", base)
        if not exponent.is_integer() or abs(exponent) > 16:
            return self.apply("pow", base, self.constant(exponent))
        result = self.constant(1.0)
        square, left = base, int(abs(exponent))
        while left:
            if left & 1:
                result = self.apply("mul", result, square)
            square = self.apply("mul", square, square)
            left >>= 1
        return self.apply("div", self.constant(1.0), result) if exponent < 0 else result

    def value_of(self, index: int) -> float | None:
        """The value of a constant node, None for any other."""
        return self._values[index]

    def is_condition(self, index: int) -> bool:
        """Whether a node is true or false by its operation."""
        return self.nodes[index].operation in BOOLEAN

    def needed(self, roots: Iterable[int], known: Collection[int] = frozenset()) -> list[int]:
        """All nodes that ``roots`` depend on, in order of evaluation, but for those ``known`` with all that they depend on."""
        stack = [root for root in roots if root not in known]
        seen = set(stack)
        while stack:
            for index in self.nodes[stack.pop()].arguments:
                if index not in seen and index not in known:
                    seen.add(index)
                    stack.append(index)
        return sorted(seen)

    def depends_on(self, kinds: frozenset[str]) -> list[bool]:
        """Per node, whether it depends on a leaf of one of ``kinds``."""
        result = self._depending.setdefault(kinds, [])
        for node in self.nodes[len(result) :]:  # what was found before stays as it is
            result.append(any(map(result.__getitem__, node.arguments)) or node.leaf in kinds)
        return result.copy()

    def _intern(self, operation: str, arguments: tuple[int, ...] = (), value: float = 0.0, leaf: str = "") -> int:
        key = (operation, arguments, value, leaf)
        index = self._index.get(key)
        if index is None:
            index = self._index[key] = len(self.nodes)
            self.nodes.append(Node(operation, arguments, value, leaf))
            self._values.append(value if operation == "constant" else None)
        return index

    def _simplify(self, operation: str, arguments: tuple[int, ...], known: list[float | None]) -> int | None:
        if operation == "where":
            condition, yes, no = arguments
            if known[0] is not None:
                return yes if known[0] else no
            return yes if yes == no else None
        if operation == "neg" and self.nodes[arguments[0]].operation == "neg":
            return self.nodes[arguments[0]].arguments[0]
        if operation not in ARITHMETIC:
            return None
        left, right = arguments
        if operation == "add":
            return right if known[0] == 0.0 else left if known[1] == 0.0 else None
        if operation == "sub":
            if known[1] == 0.0:
                return left
            return self.apply("neg", right) if known[0] == 0.0 else None
        if 0.0 in (known[0], known[1] if operation == "mul" else None):
            return self.constant(0.0)
        if known[1] == 1.0:
            return left
        if operation == "mul" and known[0] == 1.0:
            return right
        if operation == "mul" and -1.0 in known:
            return self.apply("neg", right if known[0] == -1.0 else left)
        return None


def _fold(operation: str, values: list[float]) -> float | None:
    """The value of an operation on constants, None where it is undefined."""
    try:
        if operation in ARITHMETIC:
            a, b = values
            return {"add": a + b, "sub": a - b, "mul": a * b}[operation] if operation != "div" else a / b
        if operation in COMPARISONS:
            a, b = values
            table = {"lt": a < b, "le": a <= b, "gt": a > b, "ge": a >= b, "eq": a == b, "ne": a != b}
            return float(table[operation])
        if operation in ("and", "or"):
            return float(all(values) if operation == "and" else any(values))
        if operation == "where":
            return values[1] if values[0] else values[2]
        single = {
            "neg": lambda v: -v,
            "not": lambda v: float(not v),
            "abs": abs,
            "sign": lambda v: float((v > 0) - (v < 0)),
        }
        if operation in single:
            return float(single[operation](values[0]))
        if operation in ("min", "max"):
            return min(values) if operation == "min" else max(values)
        return float(getattr(math, operation)(*values))
    except (ValueError, ZeroDivisionError, OverflowError):
        return None
