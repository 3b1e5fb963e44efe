"""From a model to the expressions of its rates, outputs and their sparse Jacobians."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import torch

from greybox_torch.codegen.arrays import UnsupportedOperation
from greybox_torch.codegen.derive import Partials, jacobian
from greybox_torch.codegen.expression import Graph
from greybox_torch.codegen.trace import nodes_of, separate_symbols, symbols
from greybox_torch.errors import UserError
from greybox_torch.model import GreyBoxModel, Signals
from greybox_torch.model.check import raised


@dataclass(frozen=True)
class Equations:
    """A model's equations as one expression graph.

    ``rates`` and ``outputs`` are root nodes; the Jacobians map leaf nodes to partial derivatives; ``sensitive`` names the parameters
    that the Jacobians cover, in the order of their columns. Tangents concern the first ``n_tangent`` states; the others
    (memories of effects that are not there) follow the trajectory without acting on it.
    """

    graph: Graph
    n_states: int
    n_inputs: int
    n_outputs: int
    n_parameters: int
    n_tangent: int
    sensitive: tuple[int, ...]
    rates: tuple[int, ...]
    outputs: tuple[int, ...]
    rates_by_state: list[Partials]
    rates_by_parameter: list[Partials]
    outputs_by_state: list[Partials]
    outputs_by_parameter: list[Partials]


def lower(model: GreyBoxModel, sensitive: Sequence[str], at_zero: Sequence[str] = ()) -> Equations:
    """Trace ``model`` and differentiate with respect to its states and the parameters named in ``sensitive``.

    Parameters in ``at_zero`` are differentiated and then set to zero everywhere: the form of a screen, in which amplitudes of effects
    that are not there ask what the output would do if they were.

    Raises:
        UnsupportedOperation: the equations use a torch operation that has no scalar form here.
        UserError: the equations raise, branch on a signal's value, or do not return what the model declares.
    """
    graph = Graph()
    names = [p.name for p in model.declared_parameters]
    x = symbols(graph, "x", len(model.states))
    u = symbols(graph, "u", len(model.inputs))
    p = Signals("parameter", dict(zip(names, separate_symbols(graph, "p", len(names)), strict=True)))
    try:
        with torch.no_grad():
            rates, outputs = (nodes_of(graph, function(x, u, p)) for function in (model.rates, model.measured))
    except (UserError, UnsupportedOperation):
        raise
    except Exception as error:  # whatever the user's equations raise, torch's complaints about other libraries among it
        raise raised(model, error) from error
    leaves_x = [graph.leaf("x", i) for i in range(len(model.states))]
    leaves_p = [graph.leaf("p", names.index(name)) for name in sensitive]
    pieces = [jacobian(graph, roots, leaves) for roots in (rates, outputs) for leaves in (leaves_x, leaves_p)]
    zeros = {graph.leaf("p", names.index(name)) for name in at_zero}
    if zeros:
        every = [*rates, *outputs, *(node for piece in pieces for row in piece for node in row.values())]
        place = with_replaced(graph, every, dict.fromkeys(zeros, graph.constant(0.0)))
        rates, outputs = tuple(place[n] for n in rates), tuple(place[n] for n in outputs)
        pieces = [
            [{v: place[n] for v, n in row.items() if graph.value_of(place[n]) != 0.0} for row in piece]
            for piece in pieces
        ]
    return Equations(
        graph,
        len(model.states),
        len(model.inputs),
        len(model.outputs),
        len(names),
        _acting_states(pieces[0], pieces[2], leaves_x),
        tuple(names.index(name) for name in sensitive),
        rates,
        outputs,
        pieces[0],
        pieces[1],
        pieces[2],
        pieces[3],
    )


def _acting_states(rates_by_state: list[Partials], outputs_by_state: list[Partials], leaves: list[int]) -> int:
    """How many leading states act on the outputs, directly or through one another."""
    acting: set[int] = {leaves.index(leaf) for row in outputs_by_state for leaf in row}
    found = True
    while found:
        reached = {leaves.index(leaf) for i in acting for leaf in rates_by_state[i]}
        found = not reached <= acting
        acting |= reached
    return max(acting) + 1 if acting else len(leaves)


def with_replaced(graph: Graph, roots: Sequence[int], other: Mapping[int, int]) -> dict[int, int]:
    """What every node that ``roots`` need becomes when some leaves give way to the nodes ``other`` (by leaf)."""
    place: dict[int, int] = {}
    changed: set[int] = set()
    for index in graph.needed(roots):
        node = graph.nodes[index]
        if index in other:
            place[index] = other[index]
        elif changed.isdisjoint(node.arguments):
            place[index] = index
        else:
            place[index] = graph.apply(node.operation, *[place[a] for a in node.arguments])
        if place[index] != index:
            changed.add(index)
    return place
