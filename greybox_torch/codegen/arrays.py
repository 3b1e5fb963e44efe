"""Arrays of expression nodes, and operations on them element by element."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from greybox_torch.codegen.expression import Graph


class UnsupportedOperation(Exception):
    """The model uses a torch operation that the compiled route does not know; the eager route still does."""


class NodeArray(np.ndarray):
    """Marks an array of nodes, apart from plain Python arguments."""


def constants(graph: Graph, values: np.ndarray) -> np.ndarray:
    """The nodes of given numbers."""
    return mapped(lambda v: graph.constant(float(v)), values)


def operand(graph: Graph, value: Any) -> np.ndarray:
    if isinstance(value, NodeArray):
        return value
    return constants(graph, np.asarray(value))


def mapped(function: Callable[..., Any], *arrays: np.ndarray) -> np.ndarray:
    """Apply ``function`` over broadcast arrays of objects."""
    if all(np.ndim(a) == 0 for a in arrays):  # by far the most
        single = np.empty((), dtype=object)
        single[()] = function(*[np.asarray(a, dtype=object)[()] for a in arrays])
        return single.view(NodeArray)
    pieces = np.broadcast_arrays(*[np.asarray(a, dtype=object) for a in arrays])
    result = np.empty(pieces[0].shape, dtype=object)
    for index in np.ndindex(result.shape):
        result[index] = function(*[piece[index] for piece in pieces])
    return result.view(NodeArray)


def elementwise(operation: str) -> Callable[..., np.ndarray]:
    def handler(graph: Graph, *operands: Any, **_: Any) -> np.ndarray:
        return mapped(lambda *n: graph.apply(operation, *n), *[operand(graph, o) for o in operands])

    return handler
