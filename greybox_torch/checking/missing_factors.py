"""Quantities of one kind that meet in units of different size, where the factor between these is missing."""

from __future__ import annotations

from collections.abc import Iterator

from greybox_torch.checking.dimensions import SECOND, known_dimension
from greybox_torch.checking.expression_text import Names, shown
from greybox_torch.checking.finding import Finding
from greybox_torch.checking.source import Source
from greybox_torch.checking.tracing import Traced
from greybox_torch.checking.unit_as_declared import as_declared
from greybox_torch.checking.unit_sizes import differ, sizes, unit_size
from greybox_torch.checking.unit_walk import ALIKE, dimensions
from greybox_torch.codegen.expression import Graph
from greybox_torch.data.units import in_base_units
from greybox_torch.model import GreyBoxModel


def missing_factors(model: GreyBoxModel, traced: Traced, source: Source) -> Iterator[Finding]:
    """Warnings where kW are added to W, and where a rate or an output is of another size than its unit.

    A free parameter makes up for such a factor, so that no fit tells, and has another value than its unit says.
    """
    graph, names = traced.graph, Names(model)
    declared = {"x": model.states, "u": model.inputs, "p": model.declared_parameters}
    units = {names.of(kind, i): q.unit for kind, of in declared.items() for i, q in enumerate(of)}
    kinds = {graph.leaf(kind, i): known_dimension(q.unit) for kind, of in declared.items() for i, q in enumerate(of)}
    leaves = {
        graph.leaf(kind, i): unit_size(q.unit, parameter=kind == "p")
        for kind, of in declared.items()
        for i, q in enumerate(of)
    }
    roots, pairs = [*traced.rates.values(), *traced.outputs.values()], []
    known = dimensions(graph, roots, kinds, lambda node: "", lambda node, what: None)
    found = sizes(graph, roots, leaves, known, lambda *place: pairs.append(place))

    def told(node: int) -> str:
        """A node's unit, its size with it."""
        of, size, dimension = graph.nodes[node], found[node], known[node]
        assert size is not None and dimension is not None
        unit_of = lambda kind, i: units.get(names.of(kind, i), "")  # noqa: E731
        text = (
            unit_of(of.leaf, int(of.value)) if of.operation == "leaf" else as_declared(graph, unit_of, node, dimension)
        )
        return text if not differ(in_base_units(text), size) else f"{size:.6g} {dimension}"

    for index, one, other in pairs:
        larger, smaller = sorted((one, other), key=lambda node: -(found[node] or 0.0))
        yield Finding(
            "warning",
            "units",
            f"{_doing(graph, index)} `{shown(graph, one, names)}`, in {told(one)}, and `{shown(graph, other, names)}`, in {told(other)}",
            f"`{shown(graph, larger, names)}` times {_times(found, larger, found[smaller])}, or both in units of one size",
            source.file,
            graph.lines.get(index),
        )
    rates = [
        (f"the rate of state '{s.name}'", traced.rates[s.name], f"{s.unit} per second", s.unit) for s in model.states
    ]
    shows = [(f"output '{o.name}'", traced.outputs[o.name], o.unit, o.unit) for o in model.outputs]
    for k, (what, node, wanted, unit) in enumerate([*rates, *shows]):
        dimension = known_dimension(unit)
        kind = dimension.times(SECOND, -1) if dimension is not None and k < len(rates) else dimension
        if known[node] is not None and known[node] == kind and differ(found[node], size := unit_size(unit)):
            yield Finding(
                "warning",
                "units",
                f"{what} is in {told(node)}, expected {wanted}",
                f"what is there times {_times(found, node, size)}",
                source.file,
                graph.lines.get(node) or (source.line_of(f'"{model.states[k].name}":') if k < len(rates) else None),
            )


def _doing(graph: Graph, index: int) -> str:
    return ALIKE.get(graph.nodes[index].operation, "chooses between")


def _times(found: dict[int, float | None], node: int, size: float | None) -> str:
    """By what a node is to be multiplied to be of that size."""
    assert size is not None
    return f"{(found[node] or 0.0) / size:.6g}"
