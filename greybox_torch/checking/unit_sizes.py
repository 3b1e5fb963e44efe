"""The size of every node of an expression graph in base units of the SI, and where sizes differ: kW added to W.

As with dimensions, a number in the code may carry the factor that is asked for, so that what is multiplied by one is of unknown size, but
by such as 2 or 1/2. So are ports' forces, plain numbers that are parameters, and percentages, which may be meant either way.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping

from greybox_torch.checking.dimensions import NONE, known_dimension
from greybox_torch.checking.unit_walk import ALIKE, KEEPING, OF_NUMBERS, Known
from greybox_torch.codegen.expression import BOOLEAN, Graph
from greybox_torch.data.units import in_base_units, per_minute

Sizes = dict[int, float | None]
"""By node; None where it is unknown."""

Differs = Callable[[int, int, int], object]
"""Is told a node and the two of its arguments that are of different size."""

ALIKE_TO = 1e-6
"""Relative difference of sizes that is rounding: units of one quantity differ by more."""


def unit_size(unit: str, *, parameter: bool = False) -> float | None:
    """A unit in base units; None where it is unknown, and of what may be a factor or count turns."""
    dimension = known_dimension(unit)
    if dimension is None or "%" in unit or per_minute(unit) or (parameter and dimension == NONE):
        return None
    return 1.0 if unit.strip() in ("1", "-", "–") else in_base_units(unit)


def differ(one: float | None, other: float | None) -> bool:
    """Whether two known sizes differ, and not by a turn, of which a unit such as 1/s or Hz does not say whether it counts it."""
    if not one or not other:
        return False
    return not any(math.isclose(one, other * turn, rel_tol=ALIKE_TO) for turn in (1.0, math.tau, 1.0 / math.tau))


def sizes(
    graph: Graph, roots: Iterable[int], leaves: Mapping[int, float | None], known: Known, differs: Differs
) -> Sizes:
    """The sizes of all nodes that ``roots`` need; ``differs`` is called once for each place, whose size then is unknown.

    Args:
        leaves: sizes of variables, by node.
        known: the dimensions of all nodes: what is of different kinds is told elsewhere, and angles are plain numbers.
    """
    found: Sizes = {}
    for index in graph.needed(roots):
        node = graph.nodes[index]
        if node.operation == "leaf":
            found[index] = leaves.get(index)
        elif node.operation == "constant":
            found[index] = 1.0 if 0.25 <= abs(node.value) <= 4.0 and (12 * node.value).is_integer() else None
        else:
            try:
                found[index] = _combined(graph, index, found, known, differs)
            except ArithmeticError:  # 1000.0 ** 200 is no number of the machine
                found[index] = None
    return found


def _combined(graph: Graph, index: int, found: Sizes, known: Known, differs: Differs) -> float | None:
    node = graph.nodes[index]
    operation, arguments = node.operation, node.arguments
    inner = [found[a] for a in arguments]
    if operation in ("mul", "div"):
        if inner[0] is None or inner[1] is None:
            return None
        return inner[0] * inner[1] if operation == "mul" else inner[0] / inner[1]
    if operation in KEEPING:
        return inner[0]
    if operation in ("sqrt", "pow"):
        power = 0.5 if operation == "sqrt" else graph.value_of(arguments[1])
        return None if inner[0] is None or power is None else inner[0] ** power
    if operation in OF_NUMBERS or operation == "sign":
        return 1.0
    if operation in ALIKE or operation == "where":
        same = _alike(graph, index, arguments[1:] if operation == "where" else arguments, found, known, differs)
        return 1.0 if operation in BOOLEAN or operation == "atan2" else same
    return 1.0 if operation in BOOLEAN else None


def _alike(
    graph: Graph, index: int, pair: tuple[int, ...], found: Sizes, known: Known, differs: Differs
) -> float | None:
    """The size that two operands have in common; a number fits any."""
    held = [a for a in pair if graph.value_of(a) is None]
    if len(held) < 2:
        return found[held[0]] if held else None
    one, other = held
    if found[one] is None or found[other] is None:
        return found[other] if found[one] is None else found[one]
    if not differ(found[one], found[other]):
        return found[one]
    if known[one] == known[other] and known[one] not in (None, NONE):
        differs(index, one, other)
    return None
