"""Symbolic differentiation of an expression graph: exact sparse Jacobians, no zeros computed."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from greybox_torch.codegen.expression import BOOLEAN, Graph

Partials = dict[int, int]
"""Derivative by variable: leaf node -> node of the partial derivative. Missing means zero."""


def jacobian(graph: Graph, roots: Sequence[int], variables: Sequence[int]) -> list[Partials]:
    """Partial derivatives of every root with respect to ``variables`` (leaf nodes), as nodes of the same graph."""
    wanted = set(variables)
    partials: dict[int, Partials] = {}
    for index in graph.needed(roots):
        node = graph.nodes[index]
        if node.operation == "leaf":
            partials[index] = {index: graph.constant(1.0)} if index in wanted else {}
            continue
        inner = [partials[a] for a in node.arguments]
        partials[index] = _chain(graph, index, inner) if any(inner) and node.operation not in BOOLEAN else {}
    return [partials[root] for root in roots]


def _chain(graph: Graph, index: int, inner: list[Partials]) -> Partials:
    node = graph.nodes[index]
    if node.operation == "where":
        condition, yes, no = node.arguments
        zero = graph.constant(0.0)
        names = inner[1].keys() | inner[2].keys()
        return _nonzero(
            graph,
            {v: graph.apply("where", condition, inner[1].get(v, zero), inner[2].get(v, zero)) for v in sorted(names)},
        )
    result: Partials = {}
    for position, piece in enumerate(inner):
        if not piece:
            continue
        outer = _LOCAL[node.operation](graph, index, position)
        is_one = graph.value_of(outer) == 1.0
        if is_one and not result:
            result = piece.copy()
            continue
        for variable, derivative in piece.items():
            term = derivative if is_one else graph.apply("mul", outer, derivative)
            result[variable] = graph.apply("add", result[variable], term) if variable in result else term
    return _nonzero(graph, result)


def _nonzero(graph: Graph, partials: Partials) -> Partials:
    return {variable: node for variable, node in partials.items() if graph.value_of(node) != 0.0}


def _one(graph: Graph, value: float = 1.0) -> int:
    return graph.constant(value)


def _over(graph: Graph, denominator: int, numerator: float = 1.0) -> int:
    return graph.apply("div", graph.constant(numerator), denominator)


def _squared(graph: Graph, node: int) -> int:
    return graph.apply("mul", node, node)


def _quotient(graph: Graph, index: int, position: int) -> int:
    denominator = graph.nodes[index].arguments[1]
    inverse = _over(graph, denominator)
    return inverse if position == 0 else graph.apply("neg", graph.apply("mul", index, inverse))


def _power(graph: Graph, index: int, position: int) -> int:
    base, exponent = graph.nodes[index].arguments
    if position == 0:
        lowered = graph.apply("pow", base, graph.apply("sub", exponent, _one(graph)))
        return graph.apply("mul", exponent, lowered)
    zero = graph.constant(0.0)
    slope = graph.apply("mul", index, graph.apply("log", base))
    return graph.apply("where", graph.apply("eq", base, zero), zero, slope)  # 0^b log 0 would be no number


def _extremum(comparison: str) -> Callable[[Graph, int, int], int]:
    def rule(graph: Graph, index: int, position: int) -> int:
        chosen = graph.apply(comparison, *graph.nodes[index].arguments)
        yes, no = (1.0, 0.0) if position == 0 else (0.0, 1.0)
        return graph.apply("where", chosen, _one(graph, yes), _one(graph, no))

    return rule


def _of_argument(rule: Callable[[Graph, int], int]) -> Callable[[Graph, int, int], int]:
    return lambda graph, index, position: rule(graph, graph.nodes[index].arguments[0])


def _root_of_one_minus_square(graph: Graph, argument: int) -> int:
    return graph.apply("sqrt", graph.apply("sub", _one(graph), _squared(graph, argument)))


def _arctangent2(graph: Graph, index: int, position: int) -> int:
    y, x = graph.nodes[index].arguments
    radius = graph.apply("add", _squared(graph, x), _squared(graph, y))
    return graph.apply("div", x if position == 0 else graph.apply("neg", y), radius)


def _bell(graph: Graph, argument: int) -> int:
    bell = graph.apply("exp", graph.apply("neg", _squared(graph, argument)))
    return graph.apply("mul", _one(graph, 2.0 / math.sqrt(math.pi)), bell)


_LOCAL: dict[str, Callable[[Graph, int, int], int]] = {
    "add": lambda g, i, k: _one(g),
    "sub": lambda g, i, k: _one(g, 1.0 if k == 0 else -1.0),
    "mul": lambda g, i, k: g.nodes[i].arguments[1 - k],
    "div": _quotient,
    "neg": lambda g, i, k: _one(g, -1.0),
    "pow": _power,
    "exp": lambda g, i, k: i,
    "expm1": lambda g, i, k: g.apply("add", i, _one(g)),
    "log": _of_argument(_over),
    "log1p": _of_argument(lambda g, a: _over(g, g.apply("add", a, _one(g)))),
    "sqrt": lambda g, i, k: _over(g, i, 0.5),
    "sin": _of_argument(lambda g, a: g.apply("cos", a)),
    "cos": _of_argument(lambda g, a: g.apply("neg", g.apply("sin", a))),
    "tan": lambda g, i, k: g.apply("add", _one(g), _squared(g, i)),
    "asin": _of_argument(lambda g, a: _over(g, _root_of_one_minus_square(g, a))),
    "acos": _of_argument(lambda g, a: _over(g, _root_of_one_minus_square(g, a), -1.0)),
    "atan": _of_argument(lambda g, a: _over(g, g.apply("add", _one(g), _squared(g, a)))),
    "atan2": _arctangent2,
    "sinh": _of_argument(lambda g, a: g.apply("cosh", a)),
    "cosh": _of_argument(lambda g, a: g.apply("sinh", a)),
    "tanh": lambda g, i, k: g.apply("sub", _one(g), _squared(g, i)),
    "erf": _of_argument(_bell),
    "abs": _of_argument(lambda g, a: g.apply("sign", a)),
    "sign": lambda g, i, k: _one(g, 0.0),
    "floor": lambda g, i, k: _one(g, 0.0),
    "min": _extremum("le"),
    "max": _extremum("ge"),
}
