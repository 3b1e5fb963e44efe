"""The equations as an expression graph that knows the line of every operation, with the forces at the ports as variables."""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from pathlib import Path

import torch

from greybox_torch.codegen.expression import Graph
from greybox_torch.codegen.trace import nodes_of, symbols
from greybox_torch.model import GreyBoxModel, Signals
from greybox_torch.model.ports import value_of


class LinedGraph(Graph):
    """Remembers in which line of ``files`` a node was made first."""

    def __init__(self, files: set[str]) -> None:
        super().__init__()
        self.lines: dict[int, int] = {}
        self._files = files

    def _intern(self, operation: str, arguments: tuple[int, ...] = (), value: float = 0.0, leaf: str = "") -> int:
        index = super()._intern(operation, arguments, value, leaf)
        if index not in self.lines and operation not in ("leaf", "constant"):
            line = self._line()
            if line is not None:
                self.lines[index] = line
        return index

    def _line(self) -> int | None:
        frame = sys._getframe(2)
        while frame is not None:
            if frame.f_code.co_filename in self._files:
                return frame.f_lineno
            frame = frame.f_back
        return None


@dataclass(frozen=True)
class Traced:
    """Root nodes by name: rates of states, outputs, and signals of ports as (port, signal)."""

    graph: LinedGraph
    rates: dict[str, int]
    outputs: dict[str, int]
    signals: dict[tuple[str, str], int] = field(default_factory=dict)


def traced(model: GreyBoxModel, file: Path | None) -> Traced:
    """Trace the equations, and the ports' signals that are functions.

    Raises UnsupportedOperation where an operation has no compiled form, and whatever the equations raise.
    """
    graph = LinedGraph({str(file)} if file else set())
    x, u, p = (
        Signals(kind, _leaves(graph, leaf, names))
        for kind, leaf, names in (
            ("state", "x", [s.name for s in model.states]),
            ("input", "u", [i.name for i in model.inputs]),
            ("parameter", "p", [q.name for q in model.declared_parameters]),
        )
    )
    declared = _leaves(graph, "f", [port.name for port in model.ports])
    zero = torch.zeros((), dtype=torch.float64)
    port = Signals("port", {q.name: declared.get(q.name, zero) for q in model.all_ports})
    with torch.no_grad():
        rates, outputs = model.derivative(x, u, p, port), model.outputs_with(x, u, p, port)
        signals = {
            (site.name, name): _node(graph, value_of(signal, x, u, p))
            for site in model.ports
            for name, signal in site.signals.items()
        }
        return Traced(
            graph,
            {s.name: _node(graph, rates[s.name]) for s in model.states},
            {o.name: _node(graph, outputs[o.name]) for o in model.outputs},
            signals,
        )


def _leaves(graph: Graph, kind: str, names: list[str]) -> dict[str, torch.Tensor]:
    if not names:
        return {}
    vector = symbols(graph, kind, len(names))
    return {name: vector.select(0, i) for i, name in enumerate(names)}


def _node(graph: Graph, value: object) -> int:
    return nodes_of(graph, torch.as_tensor(value).reshape(1))[0]
