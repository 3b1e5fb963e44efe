"""A node of an expression graph as short text, in the names of the model."""

from __future__ import annotations

from greybox_torch.codegen.expression import Graph
from greybox_torch.codegen.formula import formula
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
        text = formula(graph, index, names.of, depth)
        if len(text) <= LONGEST:
            return text
    return "…"
