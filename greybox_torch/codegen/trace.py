"""Tracing: run a model's equations once on symbols and record the scalar operations that they perform.

The symbols are tensors to the user's code (a wrapper subclass that intercepts every aten operation), each holding an array of
expression nodes, so that stacking, reshaping and small matrix products work as well as elementwise mathematics.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import torch

from greybox_torch.codegen.arrays import NodeArray, UnsupportedOperation, constants
from greybox_torch.codegen.expression import Graph
from greybox_torch.codegen.operations import AT_ONCE, HANDLERS, NAMED_AT_ONCE
from greybox_torch.errors import UserError
from greybox_torch.model.check import NEEDS_A_VALUE


class Symbol(torch.Tensor):
    """A tensor of expression nodes."""

    nodes: np.ndarray
    graph: Graph

    @staticmethod
    def of(graph: Graph, nodes: np.ndarray) -> Symbol:
        conditions = nodes.size > 0 and all(graph.is_condition(n) for n in nodes.flat)
        kind = torch.bool if conditions else torch.float64
        symbol = torch.Tensor._make_wrapper_subclass(Symbol, nodes.shape, dtype=kind)  # type: ignore[attr-defined]
        symbol.nodes, symbol.graph = nodes, graph
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
            args[0].nodes = np.broadcast_to(
                result, args[0].nodes.shape
            )  # torch hands the argument back, not the result
        return _symbols_of(graph, result)


def _symbols_of(graph: Graph, result: Any) -> Any:
    """One tensor, or those that an operation such as unbind gives."""
    return tuple(Symbol.of(graph, part) for part in result) if isinstance(result, tuple) else Symbol.of(graph, result)


def _handled(handler: Callable[..., Any], name: str, graph: Graph, args: Any, kwargs: Any) -> Any:
    operands, named = _mapped(lambda a: _nodes_of(graph, a), (args, kwargs))
    try:
        result = handler(graph, *operands, **named)
        return result if isinstance(result, tuple) else np.asarray(result, dtype=object)
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


def _graph_of(args: Any, kwargs: Any) -> Graph:
    found: list[Graph] = []
    _mapped(lambda a: found.append(a.graph) if isinstance(a, Symbol) else None, (args, kwargs))
    return found[0]


def _mapped(function: Callable[[Any], Any], value: Any) -> Any:
    """What ``function`` makes of an operation's arguments, within lists and dictionaries too; faster than torch's tree_map."""
    if type(value) in (tuple, list):
        return type(value)([_mapped(function, v) for v in value])
    if type(value) is dict:
        return {name: _mapped(function, v) for name, v in value.items()}
    return function(value)


def _nodes_of(graph: Graph, value: Any) -> Any:
    if isinstance(value, Symbol):
        return value.nodes.view(NodeArray)
    if isinstance(value, torch.Tensor):
        return constants(graph, value.detach().cpu().numpy())
    return value
