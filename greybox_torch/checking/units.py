"""Whether the equations keep to the declared units."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from functools import partial

from greybox_torch.checking.dimensions import SECOND, WATT, Dimension, dimension_of, known_dimension, per_second
from greybox_torch.checking.expression_text import Names, shown
from greybox_torch.checking.finding import Finding
from greybox_torch.checking.source import Source
from greybox_torch.checking.tracing import Traced
from greybox_torch.checking.unit_as_declared import as_declared, turns
from greybox_torch.checking.unit_walk import InUnits, Known, dimensions
from greybox_torch.codegen.expression import Graph
from greybox_torch.data.angles import has_angle
from greybox_torch.data.units import factor_in
from greybox_torch.model import Body, Coupling, GreyBoxModel

REMEDY = "what makes units fit: a number in the equation that has a unit is a parameter with that unit and fixed=True"

PER_CENT = (100.0, 0.01)
"""What turns a share in percent into a plain number."""

_FLOWS = {dimension_of(unit) for unit in ("rad/s", "m/s", "m^3/s", "A")}
"""Angular and linear speed, volume flow, current: with their efforts (torque, force, pressure, voltage) they make power."""

_PLACE_AND_CHANGE = {"body": ("position", "speed"), "coupling": ("deflection", "rate")}
"""By a port's kind the signals of which one is the rate of the other."""


def unreadable_units(model: GreyBoxModel, source: Source) -> Iterator[Finding]:
    """Findings for declared units that are none."""
    for item in (*model.states, *model.inputs, *model.outputs, *model.declared_parameters):
        try:
            dimension_of(item.unit)
        except ValueError as error:
            yield Finding(
                "warning",
                "units",
                f"{item.name}: {error}",
                _unit_instead(item.unit),
                source.file,
                source.line_of(f'"{item.name}"'),
            )


def _unit_instead(unit: str) -> str:
    factor = factor_in(unit)
    if factor is None:
        return 'a unit such as "rad/s", "N m s/rad", "kg m^2", "" where it is not to be checked'
    number, alone = factor
    return f'"{alone}", with the factor {number} in the values instead; or a unit with a prefix, such as "kN" or "MW"'


def misfits(model: GreyBoxModel, traced: Traced, source: Source) -> Iterator[Finding]:
    """Findings where quantities of different kinds meet, or a rate, an output or a port's signal is not in its unit."""
    graph, names = traced.graph, Names(model)
    found: dict[int, str] = {}
    units = {names.of(kind, i): q.unit for kind, of in _declared(model).items() for i, q in enumerate(of)}
    leaves = {
        graph.leaf(kind, i): known_dimension(q.unit) for kind, of in _declared(model).items() for i, q in enumerate(of)
    }
    text = lambda node: shown(graph, node, names)  # noqa: E731
    unit_of = lambda kind, i: units[names.of(kind, i)]  # noqa: E731
    in_units = partial(as_declared, graph, unit_of)
    signals = dimensions(graph, traced.signals.values(), leaves, text, found.setdefault, in_units)
    of_signal = {key: signals[node] for key, node in traced.signals.items()}
    for i, port in enumerate(model.ports):
        force = leaves[graph.leaf("f", i)] = _force(port, of_signal)
        units[names.of("f", i)] = "" if force is None else str(force)
    of_rates = {None if (of := known_dimension(s.unit)) is None else of.times(SECOND, -1) for s in model.states}
    roots = [*traced.rates.values(), *traced.outputs.values()]
    shares = any(q.unit.strip() == "%" for of in _declared(model).values() for q in of)
    known = dimensions(graph, roots, leaves, text, found.setdefault, in_units, PER_CENT if shares else ())
    for node, what in found.items():
        write = (
            _per_unit_of(traced, node, known, names, of_rates)
            or f"{REMEDY}; the units are {_used(traced, node, names, units)}"
        )
        yield Finding("warning", "units", what, write, source.file, graph.lines.get(node))
    differs = partial(_differs, graph, known | signals, in_units, source)
    for state in model.states:
        of, node = known_dimension(state.unit), traced.rates[state.name]
        wanted = None if of is None else of.times(SECOND, -1)
        what, write = f"the rate of state '{state.name}'", f"a rate in {per_second(state.unit)}"
        yield from differs(what, node, wanted, has_angle(state.unit), write, graph.lines.get(node))
    for output in model.outputs:
        of, node = known_dimension(output.unit), traced.outputs[output.name]
        what, write = f"output '{output.name}'", f"a value in {output.unit}"
        yield from differs(what, node, of, has_angle(output.unit), write, graph.lines.get(node))
    for port in model.ports:
        place, change = _PLACE_AND_CHANGE.get(port.kind, ("", ""))
        own = of_signal.get((port.name, place))
        if own is None:
            continue
        wanted, turning = own.times(SECOND, -1), turns(graph, unit_of, traced.signals[port.name, place])
        what, write = f"port '{port.name}', {change}", f"the rate of its {place}, in {wanted.told(turning=turning)}"
        line = source.line_of(f'"{port.name}"')
        yield from differs(what, traced.signals[port.name, change], wanted, turning, write, line)


def _differs(
    graph: Graph,
    known: Known,
    in_units: InUnits,
    source: Source,
    what: str,
    node: int,
    wanted: Dimension | None,
    turning: bool,
    write: str,
    line: int | None,
) -> Iterator[Finding]:
    found = known[node]
    if found is None or wanted is None or found == wanted or graph.value_of(node) is not None:  # a number fits any unit
        return
    told = f"{what} is in {in_units(node, found)}, expected {wanted.told(turning=turning)}"
    yield Finding("warning", "units", told, write, source.file, line)


def _declared(model: GreyBoxModel) -> dict[str, list]:
    return {"x": list(model.states), "u": list(model.inputs), "p": list(model.declared_parameters)}


def _force(port: object, of_signal: dict[tuple[str, str], Dimension | None]) -> Dimension | None:
    """A body's force times its speed is power; a coupling's force times its deflection is work; of a balance nothing is known.

    Nor is it where the speed is what a sensor shows of it (a tachometer's volts), or has been normalised: its product with a force is none.
    """
    if isinstance(port, Body):
        speed = of_signal[port.name, "speed"]
    elif isinstance(port, Coupling):
        deflection = of_signal[port.name, "deflection"]
        speed = None if deflection is None else deflection.times(SECOND, -1)
    else:
        return None
    return WATT.times(speed, -1) if speed is not None and speed in _FLOWS else None


def _per_unit_of(
    traced: Traced, node: int, known: Known, names: Names, of_rates: Collection[Dimension | None]
) -> str | None:
    """What to write where a port's force is added to an equation that is divided by a mass or the like; None elsewhere, as where the sum
    is not in the unit ``of_rates``: that is of something else, and a parameter that makes it fit is in no sensible unit.
    """
    graph = traced.graph
    ports = [
        a for a in graph.nodes[node].arguments if graph.nodes[a].operation == "leaf" and graph.nodes[a].leaf == "f"
    ]
    others = [known.get(a) for a in graph.nodes[node].arguments if a not in ports]
    if len(ports) != 1 or len(others) != 1 or others[0] is None or others[0] not in of_rates:
        return None
    if (force := known.get(ports[0])) is None:
        return None
    port = names.of("f", int(graph.nodes[ports[0]].value))
    return (
        f"`{port}` divided by the parameter in {force.times(others[0], -1)} that the equation is divided by; where the model has none, by "
        "one of value 1 with fixed=True"
    )


def _used(traced: Traced, node: int, names: Names, units: dict[str, str]) -> str:
    """The variables that a node is made of, with their units; at most six."""
    graph = traced.graph
    leaves = [graph.nodes[i] for i in graph.needed([node]) if graph.nodes[i].operation == "leaf"]
    named = [names.of(leaf.leaf, int(leaf.value)) for leaf in leaves]
    return ", ".join(f"{name} [{units.get(name) or 'no unit'}]" for name in named[:6])
