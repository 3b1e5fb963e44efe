"""Torch's operations on arrays of expression nodes, by their names."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import torch

from greybox_torch.codegen.arrays import UnsupportedOperation, elementwise, mapped, operand
from greybox_torch.codegen.expression import FUNCTIONS, Graph
from greybox_torch.codegen.matrices import MATRICES, MATRICES_AT_ONCE


def _added(sign: str, swap: bool = False) -> Callable[..., np.ndarray]:
    def handler(graph: Graph, left: Any, right: Any, alpha: float = 1) -> np.ndarray:
        left, right = (right, left) if swap else (left, right)
        scaled = operand(graph, right) if alpha == 1 else elementwise("mul")(graph, right, float(alpha))
        return elementwise(sign)(graph, left, scaled)

    return handler


def _power(graph: Graph, base: Any, exponent: Any) -> np.ndarray:
    def power(b: int, e: int) -> int:
        constant = graph.value_of(e)
        return graph.apply("pow", b, e) if constant is None else graph.power(b, constant)

    return mapped(power, operand(graph, base), operand(graph, exponent))


def _clamped(graph: Graph, value: Any, low: Any = None, high: Any = None, **named: Any) -> np.ndarray:
    low, high = named.get("min", low), named.get("max", high)
    if low is not None:
        value = elementwise("max")(graph, value, low)
    return value if high is None else elementwise("min")(graph, value, high)


def _sigmoid(graph: Graph, value: Any) -> np.ndarray:
    half = elementwise("mul")(graph, value, 0.5)
    return elementwise("mul")(graph, elementwise("add")(graph, elementwise("tanh")(graph, half), 1.0), 0.5)


def _softplus(graph: Graph, value: Any, beta: float = 1.0, threshold: float = 20.0) -> np.ndarray:
    scaled = elementwise("mul")(graph, value, beta)
    bounded = elementwise("min")(graph, scaled, threshold)
    curved = elementwise("div")(graph, elementwise("log1p")(graph, elementwise("exp")(graph, bounded)), beta)
    return elementwise("where")(graph, elementwise("gt")(graph, scaled, threshold), value, curved)


def _divided(graph: Graph, value: Any, divisor: Any, rounding_mode: str | None = None) -> np.ndarray:
    quotient = elementwise("div")(graph, value, divisor)
    if rounding_mode is None:
        return quotient
    down = elementwise("floor")(graph, quotient)
    if rounding_mode == "floor":
        return down
    up = elementwise("neg")(graph, elementwise("floor")(graph, elementwise("neg")(graph, quotient)))
    return elementwise("where")(graph, elementwise("lt")(graph, quotient, 0.0), up, down)


def _converted(graph: Graph, value: Any, *_: Any, dtype: torch.dtype | None = None, **__: Any) -> Any:
    if dtype is torch.bool:
        return elementwise("ne")(graph, value, 0.0)
    if dtype is not None and not dtype.is_floating_point:
        raise UnsupportedOperation(f"conversion to {dtype}")
    return mapped(
        lambda n: graph.apply("where", n, graph.constant(1.0), graph.constant(0.0)) if graph.is_condition(n) else n,
        value,
    )


def _reciprocal(graph: Graph, value: Any, power: float = 1.0) -> np.ndarray:
    return _power(graph, value, -power)


def _remainder(graph: Graph, value: Any, period: Any) -> np.ndarray:
    turns = elementwise("floor")(graph, elementwise("div")(graph, value, period))
    return elementwise("sub")(graph, value, elementwise("mul")(graph, turns, period))


def _indexed(graph: Graph, value: np.ndarray, dim: int, index: int) -> np.ndarray:
    return np.asarray(np.take(value, index, axis=dim), dtype=object)


def _sliced(
    graph: Graph, value: np.ndarray, dim: int = 0, start: Any = None, stop: Any = None, step: int = 1
) -> np.ndarray:
    keys: list[Any] = [slice(None)] * value.ndim
    keys[dim] = slice(start, None if stop is not None and stop > value.shape[dim] else stop, step)
    return value[tuple(keys)]


def _stacked(graph: Graph, pieces: Any, dim: int = 0) -> np.ndarray:
    return np.stack([np.asarray(p, dtype=object) for p in pieces], axis=dim)


def _joined(graph: Graph, pieces: Any, dim: int = 0) -> np.ndarray:
    return np.concatenate([np.asarray(p, dtype=object) for p in pieces], axis=dim)


def _full(value: float) -> Callable[..., np.ndarray]:
    return lambda graph, like, *_, **__: operand(graph, np.full(np.shape(like), value))


def _same(graph: Graph, value: Any, *_: Any, **__: Any) -> Any:
    return value


HANDLERS: dict[str, Callable[..., Any]] = {
    "add": _added("add"),
    "sub": _added("sub"),
    "rsub": _added("sub", swap=True),
    "mul": elementwise("mul"),
    "div": _divided,
    "pow": _power,
    "square": lambda g, a: _power(g, a, 2.0),
    "reciprocal": _reciprocal,
    "rsqrt": lambda g, a: _power(g, elementwise("sqrt")(g, a), -1.0),
    "maximum": elementwise("max"),
    "minimum": elementwise("min"),
    "clamp": _clamped,
    "clamp_min": lambda g, a, low: _clamped(g, a, low, None),
    "clamp_max": lambda g, a, high: _clamped(g, a, None, high),
    "relu": lambda g, a: _clamped(g, a, 0.0, None),
    "sigmoid": _sigmoid,
    "silu": lambda g, a: elementwise("mul")(g, a, _sigmoid(g, a)),
    "softplus": _softplus,
    "sgn": elementwise("sign"),
    "neg": elementwise("neg"),
    "remainder": _remainder,
    "heaviside": lambda g, a, at_zero: elementwise("where")(
        g, elementwise("eq")(g, a, 0.0), at_zero, elementwise("where")(g, elementwise("gt")(g, a, 0.0), 1.0, 0.0)
    ),
    "where": elementwise("where"),
    "logical_and": elementwise("and"),
    "logical_or": elementwise("or"),
    "logical_not": elementwise("not"),
    "bitwise_and": elementwise("and"),
    "bitwise_or": elementwise("or"),
    "bitwise_not": elementwise("not"),
    **MATRICES,
    "select": _indexed,
    "slice": _sliced,
    "stack": _stacked,
    "cat": _joined,
    "t": lambda g, a: a.T,
    "transpose": lambda g, a, i, j: np.swapaxes(a, i, j),
    "unsqueeze": lambda g, a, dim: np.expand_dims(a, dim if dim >= 0 else a.ndim + 1 + dim),
    "squeeze": lambda g, a, dim=None: np.squeeze(a, axis=dim),
    "view": lambda g, a, shape: np.reshape(a, shape),
    "_unsafe_view": lambda g, a, shape: np.reshape(a, shape),
    "reshape": lambda g, a, shape: np.reshape(a, shape),
    "expand": lambda g, a, shape, **_: np.broadcast_to(a, [n if n >= 0 else a.shape[i] for i, n in enumerate(shape)]),
    "detach": _same,
    "clone": _same,
    "alias": _same,
    "_to_copy": _converted,
    "lift_fresh": _same,
    "zeros_like": _full(0.0),
    "ones_like": _full(1.0),
    "new_zeros": lambda g, like, shape, **_: operand(g, np.zeros(shape)),
    "new_ones": lambda g, like, shape, **_: operand(g, np.ones(shape)),
    "full_like": lambda g, like, value, **_: operand(g, np.full(np.shape(like), value)),
    **{name: elementwise(name) for name in ("lt", "le", "gt", "ge", "eq", "ne")},
    **{name: elementwise(name) for name in ((*FUNCTIONS, "atan2"))},
}

OPERATORS: dict[str, Callable[..., Any]] = {
    **{f"__{n}__": HANDLERS[n] for n in ("add", "sub", "mul", "neg", "rsub", "lt", "le", "gt", "ge", "pow")},
    "__radd__": HANDLERS["add"],
    "__rmul__": HANDLERS["mul"],
    "__rpow__": lambda g, a, b: _power(g, b, a),
    "__truediv__": _divided,
    "__rtruediv__": lambda g, a, b: _divided(g, b, a),
    "__rdiv__": lambda g, a, b: _divided(g, b, a),
    "__and__": HANDLERS["logical_and"],
    "__or__": HANDLERS["logical_or"],
    "__invert__": HANDLERS["logical_not"],
}
"""Python's operators, by the names of their methods."""

AT_ONCE: dict[str, Callable[..., Any]] = {
    **{n: HANDLERS[n] for n in ("add", "sub", "mul", "div", "neg", "square", "clamp", "select", "stack", "new_zeros")},
    **{n: HANDLERS[n] for n in ("cat", "zeros_like", "unsqueeze", "squeeze", "unbind")},
    **{
        n: HANDLERS[n] for n in ("sigmoid", "relu", "softplus", "reciprocal", "rsqrt", "sgn", "atan2", "rsub", "detach")
    },
    **{n: HANDLERS[n] for n in ("logical_and", "logical_or", "logical_not", "ones_like", "clamp_min", "clamp_max")},
    **{name: HANDLERS[name] for name in ("where", "maximum", "minimum", "lt", "le", "gt", "ge", *FUNCTIONS)},
    **OPERATORS,
    "true_divide": HANDLERS["div"],
    "expand": lambda g, a, *shape: HANDLERS["expand"](g, a, shape if shape and isinstance(shape[0], int) else shape[0]),
    "broadcast_tensors": lambda g, *several: tuple(np.broadcast_arrays(*[operand(g, a) for a in several], subok=True)),
    "pow": _power,
    **MATRICES_AT_ONCE,
}
"""Operations that are handled as they are called, by the names of torch's functions and methods."""

NAMED_AT_ONCE = {"dim", "min", "max"}
"""Arguments that these take by name, too."""
