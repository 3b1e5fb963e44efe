"""A node of an expression graph as short text, in the names of the model."""

from __future__ import annotations

from greybox_torch.codegen.expression import ARITHMETIC, COMPARISONS, Graph
from greybox_torch.model import GreyBoxModel

LONGEST = 60


class Names:
    """The names of leaves, as the equations write them."""

    def __init__(self, model: GreyBoxModel) -> None:
        self._of = {
            "x": [f"x.{s.name}" for s in model.states],
            "u": [f"u.{i.name}" for i in model.inputs],
            "p": [f"p.{q.name}" for q in model.declared_parameters],
            "f": [f"port.{port.name}" for port in model.ports],
        }

    def of(self, kind: str, index: int) -> str:
        return self._of[kind][index]


def shown(graph: Graph, index: int, names: Names) -> str:
    """At most LONGEST characters; what is left out is shown as …"""
    for depth in (6, 4, 3, 2, 1):
        text = _text(graph, index, names, depth)
        if len(text) <= LONGEST:
            return text
    return "…"


def _text(graph: Graph, index: int, names: Names, depth: int) -> str:
    node = graph.nodes[index]
    if node.operation == "constant":
        return f"{node.value:g}"
    if node.operation == "leaf":
        return names.of(node.leaf, int(node.value))
    if depth == 0:
        return "…"
    inner = [_text(graph, a, names, depth - 1) for a in node.arguments]
    sign = {**ARITHMETIC, **COMPARISONS}.get(node.operation)
    if sign is not None:
        left, right = (_bracketed(graph, a, text) for a, text in zip(node.arguments, inner, strict=True))
        return f"{left} {sign} {right}"
    if node.operation == "neg":
        return f"-{_bracketed(graph, node.arguments[0], inner[0])}"
    return f"{node.operation}({', '.join(inner)})"


def _bracketed(graph: Graph, index: int, text: str) -> str:
    return f"({text})" if graph.nodes[index].operation in ("add", "sub") and text != "…" else text
