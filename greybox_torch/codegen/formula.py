"""A node of an expression graph as a line of text, as one writes it in Python."""

from __future__ import annotations

from collections.abc import Callable

from greybox_torch.codegen.expression import ARITHMETIC, COMPARISONS, LOGIC, Graph

_SIGNS = {**ARITHMETIC, **COMPARISONS, **LOGIC}
_BINDING = {**dict.fromkeys(COMPARISONS, 0), **dict.fromkeys(LOGIC, 1), "add": 2, "sub": 2, "mul": 3, "div": 3}
"""How strongly a sign binds: what binds less than the sign beside it stands in brackets."""
_STRONGEST = 4


def formula(graph: Graph, index: int, name: Callable[[str, int], str], depth: int = 100) -> str:
    """The node, with leaves by the ``name`` of their kind and place; what is deeper than ``depth`` operations is shown as …"""
    return _text(graph, index, name, depth, 0)


def _text(graph: Graph, index: int, name: Callable[[str, int], str], depth: int, beside: int) -> str:
    node = graph.nodes[index]
    operation, arguments = node.operation, node.arguments
    if operation == "constant":
        return f"({node.value:g})" if node.value < 0 and beside else f"{node.value:g}"
    if operation == "leaf":
        return name(node.leaf, int(node.value))
    if depth == 0:
        return "…"
    if operation == "neg":
        text = f"-{_text(graph, arguments[0], name, depth - 1, _BINDING['mul'])}"
        return f"({text})" if beside == _STRONGEST else text
    base, exponent = _power(graph, index)
    if exponent > 1:
        return f"{_text(graph, base, name, depth - 1, _STRONGEST)} ** {exponent}"
    if operation in _SIGNS:
        own = _BINDING[operation]
        second = graph.nodes[arguments[1]].operation == "neg"
        after = _STRONGEST if second else own + (operation in ("sub", "div"))
        left, right = (_text(graph, a, name, depth - 1, b) for a, b in zip(arguments, (own, after), strict=True))
        text = f"{left} {_SIGNS[operation]} {right}"
        return f"({text})" if own < beside else text
    return f"{operation}({', '.join(_text(graph, a, name, depth - 1, 0) for a in arguments)})"


def _power(graph: Graph, index: int) -> tuple[int, int]:
    """The node as a base and its exponent: a product of equal factors is held as multiplications."""
    node = graph.nodes[index]
    if node.operation == "mul":
        (left, m), (right, n) = (_power(graph, a) for a in node.arguments)
        if left == right:
            return left, m + n
    return index, 1
