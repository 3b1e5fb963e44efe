"""The dimension of every node of an expression graph, and where dimensions do not fit.

A number in the code may carry a unit of its own: where it is added it fits anything, and what is multiplied by it has an unknown
dimension, unless it is a small fraction or of π. An unknown dimension fits anything.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping
from fractions import Fraction

from greybox_torch.checking.dimensions import NONE, Dimension
from greybox_torch.codegen.expression import BOOLEAN, COMPARISONS, Graph

Misfit = Callable[[int, str], object]
"""Is told a node and what does not fit there."""

InUnits = Callable[[int, Dimension], str]
"""How the dimension of a node is written."""

OF_NUMBERS = {
    "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "expm1", "log", "log1p", "erf",
}  # fmt: skip
KEEPING = {"neg", "abs", "floor"}
ALIKE = {"add": "adds", "sub": "subtracts", "min": "takes the smaller of", "max": "takes the larger of"}
ALIKE |= dict.fromkeys(COMPARISONS, "compares") | {"atan2": "takes the angle of"}

Known = dict[int, Dimension | None]
"""By node; None where it is unknown."""


def dimensions(
    graph: Graph,
    roots: Iterable[int],
    leaves: Mapping[int, Dimension | None],
    text: Callable[[int], str],
    misfit: Misfit,
    in_units: InUnits = lambda _, dimension: str(dimension),
    plain: Collection[float] = (),
) -> Known:
    """The dimensions of all nodes that ``roots`` need; ``misfit`` is called once for each place, whose dimension then is unknown. Numbers
    of ``plain`` carry no unit.
    """
    known: Known = {}
    for index in graph.needed(roots):
        node = graph.nodes[index]
        if node.operation == "leaf":
            known[index] = leaves.get(index)
        elif node.operation == "constant":
            known[index] = NONE if node.value in plain or _is_plain(node.value) else None
        else:
            known[index] = _combined(graph, index, known, text, misfit, in_units)
    return known


def _combined(
    graph: Graph, index: int, known: Known, text: Callable[[int], str], misfit: Misfit, in_units: InUnits
) -> Dimension | None:
    node = graph.nodes[index]
    operation, arguments = node.operation, node.arguments
    inner = [known[a] for a in arguments]
    if operation in ("mul", "div"):
        if inner[0] is None or inner[1] is None:
            return None
        return inner[0].times(inner[1], 1 if operation == "mul" else -1)
    if operation in KEEPING:
        return inner[0]
    if operation == "sqrt":
        return None if inner[0] is None else inner[0].to_the(Fraction(1, 2))
    if operation == "pow":
        return _power(graph, arguments, inner)
    if operation in OF_NUMBERS:
        if inner[0] is not None and inner[0] != NONE:
            unit = in_units(arguments[0], inner[0])
            misfit(index, f"takes {operation} of `{text(arguments[0])}`, which is in {unit} and not a plain number")
        return NONE
    if operation == "sign":
        return NONE
    if operation in ALIKE or operation == "where":
        pair = arguments[1:] if operation == "where" else arguments
        same = _alike(graph, index, pair, known, text, misfit, in_units)
        return NONE if operation in BOOLEAN or operation == "atan2" else same
    return NONE if operation in BOOLEAN else None


def _alike(
    graph: Graph,
    index: int,
    pair: tuple[int, ...],
    known: Known,
    text: Callable[[int], str],
    misfit: Misfit,
    in_units: InUnits,
) -> Dimension | None:
    """The dimension that two operands have in common; a number fits any."""
    held = [a for a in pair if graph.value_of(a) is None]
    if len(held) < 2:
        return known[held[0]] if held else None
    one, other = (known[a] for a in held)
    if one is None or other is None:
        return one if other is None else other
    if one != other:
        doing = ALIKE.get(graph.nodes[index].operation, "chooses between")
        first, second = (f"`{text(a)}`, in {in_units(a, of)}" for a, of in zip(held, (one, other), strict=True))
        misfit(index, f"{doing} {first}, and {second}")
        return None
    return one


def _power(graph: Graph, arguments: tuple[int, ...], inner: list[Dimension | None]) -> Dimension | None:
    exponent = graph.value_of(arguments[1])
    if inner[0] is None or exponent is None:
        return NONE if inner[0] == NONE else None
    return inner[0].to_the(Fraction(exponent).limit_denominator(12))


def _is_plain(value: float) -> bool:
    """Whether a number hardly carries a unit: small fractions, and those of π."""
    return (abs(value) <= 16 and any((12 * value / base).is_integer() for base in (1.0, math.pi))) or (
        (360 * value / math.pi).is_integer() and abs(value) <= 16 * math.pi
    )
