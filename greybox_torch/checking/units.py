"""Whether the equations keep to the declared units."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from functools import partial

from greybox_torch.checking.dimensions import SECOND, WATT, Dimension, dimension_of, known_dimension
from greybox_torch.checking.expression_text import Names, shown
from greybox_torch.checking.finding import Finding
from greybox_torch.checking.source import Source
from greybox_torch.checking.tracing import Traced
from greybox_torch.checking.unit_as_declared import as_declared
from greybox_torch.checking.unit_walk import Known, dimensions
from greybox_torch.data.units import factor_in
from greybox_torch.model import Body, Coupling, GreyBoxModel

REMEDY = "what makes units fit: a number in the equation that has a unit is a parameter with that unit and fixed=True"

_FLOWS = {dimension_of(unit) for unit in ("rad/s", "m/s", "m^3/s", "A")}
"""Angular and linear speed, volume flow, current: with their efforts (torque, force, pressure, voltage) they make power."""


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
    in_units = partial(as_declared, graph, lambda kind, i: units[names.of(kind, i)])
    signals = dimensions(graph, traced.signals.values(), leaves, text, found.setdefault, in_units)
    of_signal = {key: signals[node] for key, node in traced.signals.items()}
    for i, port in enumerate(model.ports):
        force = leaves[graph.leaf("f", i)] = _force(port, of_signal)
        units[names.of("f", i)] = "" if force is None else str(force)
    of_rates = {None if (of := known_dimension(s.unit)) is None else of.times(SECOND, -1) for s in model.states}
    roots = [*traced.rates.values(), *traced.outputs.values()]
    known = dimensions(graph, roots, leaves, text, found.setdefault, in_units)
    for node, what in found.items():
        write = (
            _per_unit_of(traced, node, known, names, of_rates)
            or f"{REMEDY}; the units are {_used(traced, node, names, units)}"
        )
        yield Finding("warning", "units", what, write, source.file, graph.lines.get(node))
    for name, node in traced.rates.items():
        unit = next(s.unit for s in model.states if s.name == name)
        wanted = known_dimension(unit)
        yield from _differs(
            f"the rate of state '{name}'",
            known[node],
            None if wanted is None else wanted.times(SECOND, -1),
            f"a rate in {unit} per second",
            source,
            graph.lines.get(node),
        )
    for name, node in traced.outputs.items():
        unit = next(o.unit for o in model.outputs if o.name == name)
        yield from _differs(
            f"output '{name}'", known[node], known_dimension(unit), f"a value in {unit}", source, graph.lines.get(node)
        )
    yield from _ports(model, of_signal, source)


def _ports(
    model: GreyBoxModel, of_signal: dict[tuple[str, str], Dimension | None], source: Source
) -> Iterator[Finding]:
    pairs = {"body": ("position", "speed"), "coupling": ("deflection", "rate")}
    for port in model.ports:
        place, change = pairs.get(port.kind, ("", ""))
        own, rate = of_signal.get((port.name, place)), of_signal.get((port.name, change))
        if own is None:
            continue
        wanted = own.times(SECOND, -1)
        yield from _differs(
            f"port '{port.name}', {change}", rate, wanted, f"the rate of its {place}, in {wanted}", source,
            source.line_of(f'"{port.name}"'),
        )  # fmt: skip


def _differs(
    what: str, found: Dimension | None, wanted: Dimension | None, write: str, source: Source, line: int | None
) -> Iterator[Finding]:
    if found is not None and wanted is not None and found != wanted:
        yield Finding("warning", "units", f"{what} is in {found}, expected {wanted}", write, source.file, line)


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
