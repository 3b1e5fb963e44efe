"""Tracing: run a model's equations once on symbols and record the scalar operations that they perform.

The symbols are tensors to the user's code (a wrapper subclass that intercepts every aten operation), each holding an array of
expression nodes, so that stacking, reshaping and small matrix products work as well as elementwise mathematics.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import torch

from greybox_torch.codegen.arrays import NodeArray, UnsupportedOperation, constants, single
from greybox_torch.codegen.expression import Graph
from greybox_torch.codegen.operations import AT_ONCE, HANDLERS, NAMED_AT_ONCE, OPERATORS
from greybox_torch.errors import UserError
from greybox_torch.model.check import NEEDS_A_VALUE


class Symbol(torch.Tensor):
    """A tensor of expression nodes."""

    nodes: np.ndarray
    graph: Graph

    @staticmethod
    def of(graph: Graph, nodes: np.ndarray) -> Symbol:
        each = nodes.ravel().tolist()
        conditions = each and all(map(graph.is_condition, each))
        kind = torch.bool if conditions else torch.float64
        symbol = torch.Tensor._make_wrapper_subclass(Symbol, nodes.shape, dtype=kind)  # type: ignore[attr-defined]
        symbol.nodes, symbol.graph = nodes.view(NodeArray), graph
        return symbol

    @classmethod
    def __torch_function__(cls, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        """The common operations at once; all others by way of ``__torch_dispatch__``, where torch has them in its basic forms.

        The first operation that goes there makes torch import its distributed tensors, half a second of the life of a process.
        """
        name = getattr(func, "__name__", "")
        kwargs = kwargs or {}
        handler = AT_ONCE.get(name) if kwargs.keys() <= NAMED_AT_ONCE else None
        if handler is None:
            return torch._C._disabled_torch_function_impl(func, types, args, kwargs)  # type: ignore[attr-defined]
        graph = _graph_of(args, kwargs)
        return _symbols_of(graph, _handled(handler, name, graph, args, kwargs))

    @classmethod
    def __torch_dispatch__(cls, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        kwargs = kwargs or {}
        graph = _graph_of(args, kwargs)
        name = func._schema.name.removeprefix("aten::").rstrip("_") if not func._schema.name.endswith("__") else ""
        handler = HANDLERS.get(name)
        if handler is None:
            if name == "_local_scalar_dense":
                raise UserError(NEEDS_A_VALUE)
            raise UnsupportedOperation(f"torch operation '{func._schema.name}'")
        result = _handled(handler, func._schema.name, graph, args, kwargs)
        if func._schema.name.endswith("_") and isinstance(args[0], Symbol):
            # torch hands the argument back, not the result
            args[0].nodes = np.broadcast_to(result, args[0].nodes.shape).view(NodeArray)
        return _symbols_of(graph, result)


def _operator(name: str, handler: Callable[..., Any]) -> Callable[[Symbol, Any], Symbol]:
    """An operator of symbols without torch in between: it takes longer to call back than the operation."""

    def method(self: Symbol, *other: Any) -> Symbol:
        return Symbol.of(self.graph, _handled(handler, name, self.graph, (self, *other), {}))

    return method


for _name, _handler in OPERATORS.items():
    setattr(Symbol, _name, _operator(_name, _handler))


def _symbols_of(graph: Graph, result: Any) -> Any:
    """One tensor, or those that an operation such as unbind gives."""
    return tuple(Symbol.of(graph, part) for part in result) if isinstance(result, tuple) else Symbol.of(graph, result)


def _handled(handler: Callable[..., Any], name: str, graph: Graph, args: Any, kwargs: Any) -> Any:
    operands = [_nodes_of(graph, a) for a in args]
    named = {key: _nodes_of(graph, a) for key, a in kwargs.items()}
    try:
        result = handler(graph, *operands, **named)
        return result if isinstance(result, tuple | NodeArray) else np.asarray(result, dtype=object)
    except (TypeError, ValueError, IndexError) as error:  # a form of the operation that its handler was not written for
        raise UnsupportedOperation(f"torch operation '{name}' in this form") from error


def nodes_of(graph: Graph, tensor: torch.Tensor) -> tuple[int, ...]:
    """The nodes of a vector that tracing gave, also where it does not depend on any symbol."""
    return tuple(int(node) for node in _nodes_of(graph, tensor))


def symbols(graph: Graph, kind: str, count: int) -> Symbol:
    """A vector of ``count`` leaves of one kind (``x``, ``u`` or ``p``)."""
    nodes = np.empty(count, dtype=object)
    nodes[:] = [graph.leaf(kind, i) for i in range(count)]
    return Symbol.of(graph, nodes)


def separate_symbols(graph: Graph, kind: str, count: int) -> list[Symbol]:
    """The same leaves one by one."""
    return [Symbol.of(graph, single(graph.leaf(kind, i))) for i in range(count)]


def _graph_of(args: Any, kwargs: Any) -> Graph:
    graph = _first_graph(args) or _first_graph(kwargs.values())
    assert graph is not None  # torch asks us because of a symbol
    return graph


def _first_graph(values: Iterable[Any]) -> Graph | None:
    for value in values:
        found = value.graph if type(value) is Symbol else _first_graph(value) if type(value) in (tuple, list) else None
        if found is not None:
            return found
    return None


def _nodes_of(graph: Graph, value: Any) -> Any:
    """An argument of an operation with the nodes of its tensors, within lists, too."""
    if type(value) is Symbol:
        return value.nodes
    if type(value) in (tuple, list):
        return type(value)([_nodes_of(graph, v) for v in value])
    if isinstance(value, torch.Tensor):
        return constants(graph, value.detach().cpu().numpy())
    return value
