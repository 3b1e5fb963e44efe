"""A scalar expression graph with common-subexpression elimination, the form in which a traced model is held."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable
from dataclasses import dataclass

ARITHMETIC = {"add": "+", "sub": "-", "mul": "*", "div": "/"}
COMPARISONS = {"lt": "<", "le": "<=", "gt": ">", "ge": ">=", "eq": "==", "ne": "!="}
LOGIC = {"and": "&", "or": "|"}
FUNCTIONS = (
    "exp", "log", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh",
    "floor", "abs", "sign", "erf", "log1p", "expm1",
)  # fmt: skip
BOOLEAN = frozenset({*COMPARISONS, *LOGIC, "not"})


@dataclass(frozen=True)
class Node:
    """One operation: its name, its arguments (indices of earlier nodes), and the value of a constant or index of a leaf."""

    operation: str
    arguments: tuple[int, ...] = ()
    value: float = 0.0
    leaf: str = ""


class Graph:
    """Nodes in order of creation, so that arguments always come before their use. Equal nodes are one node."""

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self._index: dict[Node, int] = {}

    def constant(self, value: float) -> int:
        return self._intern(Node("constant", value=float(value)))

    def leaf(self, kind: str, index: int) -> int:
        """A variable: ``x``, ``u`` or ``p`` with its position."""
        return self._intern(Node("leaf", value=float(index), leaf=kind))

    def apply(self, operation: str, *arguments: int) -> int:
        """The node of ``operation`` on ``arguments``, folded and simplified where that is exact."""
        known = [self.value_of(a) for a in arguments]
        if all(value is not None for value in known):
            folded = _fold(operation, [v for v in known if v is not None])
            if folded is not None:
                return self.constant(folded)
        simple = self._simplify(operation, arguments, known)
        return simple if simple is not None else self._intern(Node(operation, arguments))

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
        node = self.nodes[index]
        return node.value if node.operation == "constant" else None

    def is_condition(self, index: int) -> bool:
        """Whether a node is true or false by its operation."""
        return self.nodes[index].operation in BOOLEAN

    def needed(self, roots: Iterable[int], known: Collection[int] = frozenset()) -> list[int]:
        """All nodes that ``roots`` depend on, in order of evaluation, but for those ``known`` with all that they depend on."""
        seen: set[int] = set()
        stack = list(roots)
        while stack:
            index = stack.pop()
            if index not in seen and index not in known:
                seen.add(index)
                stack.extend(self.nodes[index].arguments)
        return sorted(seen)

    def depends_on(self, kinds: frozenset[str]) -> list[bool]:
        """Per node, whether it depends on a leaf of one of ``kinds``."""
        result: list[bool] = []
        for node in self.nodes:
            result.append(node.leaf in kinds if node.operation == "leaf" else any(result[a] for a in node.arguments))
        return result

    def _intern(self, node: Node) -> int:
        if node not in self._index:
            self._index[node] = len(self.nodes)
            self.nodes.append(node)
        return self._index[node]

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
