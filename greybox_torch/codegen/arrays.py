"""Arrays of expression nodes, and operations on them element by element."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
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
    if type(value) is NodeArray:
        return value
    if type(value) in (float, int):
        return single(graph.constant(value))
    return constants(graph, np.asarray(value))


def single(node: int) -> np.ndarray:
    """One node as an array without dimensions."""
    array = NodeArray((), object)
    array[()] = node
    return array


def mapped(function: Callable[..., Any], *arrays: np.ndarray) -> np.ndarray:
    """Apply ``function`` over broadcast arrays of objects."""
    if not any(a.ndim for a in arrays):  # by far the most
        return single(function(*[a.item() for a in arrays]))
    pieces = np.broadcast_arrays(*[np.asarray(a, dtype=object) for a in arrays])
    result = np.empty(pieces[0].shape, dtype=object)
    for index in np.ndindex(result.shape):
        result[index] = function(*[piece[index] for piece in pieces])
    return result.view(NodeArray)


def elementwise(operation: str) -> Callable[..., np.ndarray]:
    def handler(graph: Graph, *operands: Any, **_: Any) -> np.ndarray:
        return mapped(partial(graph.apply, operation), *[operand(graph, o) for o in operands])

    return handler
