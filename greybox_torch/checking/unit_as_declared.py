"""The unit of a product in the units that its factors are declared with: "N m A/V" says more than "A^2 s"."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable

from greybox_torch.checking.dimensions import Dimension, dimension_of, known_dimension
from greybox_torch.codegen.expression import Graph
from greybox_torch.data.angles import has_angle

UnitOf = Callable[[str, int], str]
"""The declared unit of a leaf, by its kind and number."""

_FACTOR = re.compile(r"(°?[^\W\d_]+|°)(?:\^(\d+))?")
_NUMBERS = ("1", "-", "–", "%")
"""Of plain numbers, which a product is told without."""
_TIMES = re.compile(r"[*·⋅]")
_UNITS = re.compile(r"([^/()]+)(?:/(?:\(([^/()]+)\)|([^/()]+)))?")

_ENERGY = re.compile(r"\b\w*(J|Wh?)\b")
"""Of units that have the dimension of a torque."""

_TORQUE_AND_INERTIA = {dimension_of("N m"), dimension_of("kg m^2")}


def as_declared(graph: Graph, unit_of: UnitOf, node: int, dimension: Dimension) -> str:
    """How the ``dimension`` of a node is told: by its name if it has one, of a product by the units of its factors, else in base units."""
    factors = None if dimension.has_name else _factors(graph, unit_of, node, 1)
    if not factors:
        return dimension.told(turning=turns(graph, unit_of, node))
    above = " ".join(_powers(factors, 1))
    below = _powers(factors, -1)
    whole = (above or "1") + (f"/({' '.join(below)})" if len(below) > 1 else f"/{below[0]}" if below else "")
    return whole if known_dimension(whole) == dimension else str(dimension)


def turns(graph: Graph, unit_of: UnitOf, node: int) -> bool:
    """Whether a node is made of what turns: of an angle by its declared unit, of a torque or an inertia."""
    leaves = (graph.nodes[i] for i in graph.needed([node]) if graph.nodes[i].operation == "leaf")
    units = [unit_of(leaf.leaf, int(leaf.value)) for leaf in leaves]
    return any(
        has_angle(unit) or (known_dimension(unit) in _TORQUE_AND_INERTIA and not _ENERGY.search(unit)) for unit in units
    )


def _powers(factors: Counter[str], sign: int) -> list[str]:
    powers = ((name, sign * power) for name, power in factors.items() if sign * power > 0)
    return [name if power == 1 else f"{name}^{power}" for name, power in powers]


def _factors(graph: Graph, unit_of: UnitOf, node: int, power: int) -> Counter[str] | None:
    """By unit the power in which a product has it, in the order written; None of what is no product of variables."""
    of = graph.nodes[node]
    if of.operation == "constant":
        return Counter()
    if of.operation == "leaf":
        return _read(unit_of(of.leaf, int(of.value)), power)
    if of.operation == "neg":
        return _factors(graph, unit_of, of.arguments[0], power)
    if of.operation not in ("mul", "div"):
        return None
    one = _factors(graph, unit_of, of.arguments[0], power)
    other = _factors(graph, unit_of, of.arguments[1], power if of.operation == "mul" else -power)
    if one is None or other is None:
        return None
    one.update(other)  # adds powers, and keeps negative ones
    return one


def _read(unit: str, power: int) -> Counter[str] | None:
    """Of a unit such as "N m/(V A)", "N*m/V" or "1/s"; None of one that is written otherwise."""
    found = _UNITS.fullmatch(_TIMES.sub(" ", unit.replace("**", "^")).strip())
    if found is None:
        return None
    powers: Counter[str] = Counter()
    for written, sign in ((found[1], power), (found[2] or found[3] or "", -power)):
        for one in written.split():
            factor = _FACTOR.fullmatch(one)
            if factor is not None:
                powers[factor[1]] += sign * int(factor[2] or 1)
            elif one not in _NUMBERS:
                return None
    return powers
