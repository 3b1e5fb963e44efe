"""Quantities of one kind that meet in units of different size, where the factor between these is missing."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from greybox_torch.checking.dimensions import SECOND, Dimension, known_dimension, per_second
from greybox_torch.checking.expression_text import Names, shown
from greybox_torch.checking.finding import Finding
from greybox_torch.checking.source import Source
from greybox_torch.checking.tracing import LinedGraph, Traced
from greybox_torch.checking.unit_as_declared import as_declared
from greybox_torch.checking.unit_sizes import differ, sizes, unit_size
from greybox_torch.checking.unit_walk import ALIKE, dimensions
from greybox_torch.codegen.expression import Graph
from greybox_torch.data.units import in_base_units
from greybox_torch.model import GreyBoxModel


@dataclass(frozen=True)
class _Walked:
    """The nodes of the equations with what is known of each: dimensions, sizes; ``pairs`` are the places whose two operands differ in size,
    each with these two.
    """

    graph: LinedGraph
    names: Names
    units: Mapping[str, str]
    known: Mapping[int, Dimension | None]
    found: Mapping[int, float | None]
    pairs: Sequence[tuple[int, int, int]]

    def shown(self, node: int) -> str:
        """A node's expression, as code."""
        return f"`{shown(self.graph, node, self.names)}`"

    def told(self, node: int) -> str:
        """A node's unit, its size with it."""
        of, size, dimension = self.graph.nodes[node], self.found[node], self.known[node]
        assert size is not None and dimension is not None
        leaf = of.operation == "leaf"
        declared = self._unit_of(of.leaf, int(of.value)) if leaf else ""
        text = declared if leaf else as_declared(self.graph, self._unit_of, node, dimension)
        return text if not differ(in_base_units(text), size) else f"{size:.6g} {dimension}"

    def times(self, node: int, size: float | None) -> str:
        """By what a node is to be multiplied to be of that size."""
        assert size is not None
        return f"{(self.found[node] or 0.0) / size:.6g}"

    def _unit_of(self, kind: str, index: int) -> str:
        return self.units.get(self.names.of(kind, index), "")


@dataclass(frozen=True)
class _Root:
    """A rate or an output: ``what`` it is in words, its ``node``, the unit ``wanted`` in words, its ``dimension`` and ``size``, and the
    ``line`` that it is told at where its own is not known.
    """

    what: str
    node: int
    wanted: str
    dimension: Dimension | None
    size: float | None
    line: int | None = None


def missing_factors(model: GreyBoxModel, traced: Traced, source: Source) -> Iterator[Finding]:
    """Warnings where kW are added to W, and where a rate or an output is of another size than its unit.

    A free parameter makes up for such a factor, so that no fit tells, and has another value than its unit says.
    """
    walked = _walked(model, traced)
    yield from _of_pairs(walked, source)
    yield from _of_roots(walked, [*_rates(model, traced, source), *_shows(model, traced)], source)


def _walked(model: GreyBoxModel, traced: Traced) -> _Walked:
    graph, names = traced.graph, Names(model)
    declared = {"x": model.states, "u": model.inputs, "p": model.declared_parameters}
    signals = [(kind, i, q) for kind, of in declared.items() for i, q in enumerate(of)]
    units = {names.of(kind, i): q.unit for kind, i, q in signals}
    kinds = {graph.leaf(kind, i): known_dimension(q.unit) for kind, i, q in signals}
    leaves = {graph.leaf(kind, i): unit_size(q.unit, parameter=kind == "p") for kind, i, q in signals}
    roots, pairs = [*traced.rates.values(), *traced.outputs.values()], list[tuple[int, int, int]]()
    known = dimensions(graph, roots, kinds, lambda node: "", lambda node, what: None)
    found = sizes(graph, roots, leaves, known, lambda *place: pairs.append(place))
    return _Walked(graph, names, units, known, found, pairs)


def _of_pairs(walked: _Walked, source: Source) -> Iterator[Finding]:
    for index, *pair in walked.pairs:
        larger, smaller = sorted(pair, key=lambda node: -(walked.found[node] or 0.0))
        one, other = (f"{walked.shown(node)}, in {walked.told(node)}" for node in pair)
        yield Finding(
            "warning",
            "units",
            f"{_doing(walked.graph, index)} {one}, and {other}",
            f"{walked.shown(larger)} times {walked.times(larger, walked.found[smaller])}, or both in units of one size",
            source.file,
            walked.graph.lines.get(index),
        )


def _rates(model: GreyBoxModel, traced: Traced, source: Source) -> Iterator[_Root]:
    for state in model.states:
        dimension, line = known_dimension(state.unit), source.line_of(f'"{state.name}":')
        rate = None if dimension is None else dimension.times(SECOND, -1)
        what, wanted = f"the rate of state '{state.name}'", per_second(state.unit)
        yield _Root(what, traced.rates[state.name], wanted, rate, unit_size(state.unit), line)


def _shows(model: GreyBoxModel, traced: Traced) -> Iterator[_Root]:
    for one in model.outputs:
        node, dimension = traced.outputs[one.name], known_dimension(one.unit)
        yield _Root(f"output '{one.name}'", node, one.unit, dimension, unit_size(one.unit))


def _of_roots(walked: _Walked, roots: Sequence[_Root], source: Source) -> Iterator[Finding]:
    for root in roots:
        if walked.graph.value_of(root.node) is not None:  # a number fits any unit
            continue
        known = walked.known[root.node]
        if known is not None and known == root.dimension and differ(walked.found[root.node], root.size):
            yield Finding(
                "warning",
                "units",
                f"{root.what} is in {walked.told(root.node)}, expected {root.wanted}",
                f"what is there times {walked.times(root.node, root.size)}",
                source.file,
                walked.graph.lines.get(root.node) or root.line,
            )


def _doing(graph: Graph, index: int) -> str:
    return ALIKE.get(graph.nodes[index].operation, "chooses between")
