"""Everything that can be said of a model before any data."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass

from greybox_torch.checking.code import untraceable
from greybox_torch.checking.declarations import (
    declared_twice,
    missing_methods,
    no_ports,
    not_declared,
    port_signals,
    unusable_names,
)
from greybox_torch.checking.effects import without_effect
from greybox_torch.checking.equations import compiled, fails, told
from greybox_torch.checking.finding import Finding, in_order
from greybox_torch.checking.heat_flows import heat_against_the_fall
from greybox_torch.checking.influence import Influence, influence
from greybox_torch.checking.missing_factors import missing_factors
from greybox_torch.checking.names import declared_names, exchanged_arguments, left_out, unknown_names
from greybox_torch.checking.negative_masses import negative_masses, with_masses_above_zero
from greybox_torch.checking.not_finite import never_finite, not_finite, not_finite_at_start
from greybox_torch.checking.places_and_rates import rates_of_places
from greybox_torch.checking.points import Points, points_of, start_of, wide_points
from greybox_torch.checking.port_signs import turned_ports
from greybox_torch.checking.source import Source, source_of
from greybox_torch.checking.units import misfits, unreadable_units
from greybox_torch.errors import UserError
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.check import raised


@dataclass(frozen=True)
class Examination:
    """Findings, errors first. ``model`` is None where no object could be made, ``influence`` where the equations do not run;
    ``compiled`` says whether they have a compiled form.
    """

    made: type[GreyBoxModel]
    model: GreyBoxModel | None
    findings: tuple[Finding, ...]
    influence: Influence | None = None
    compiled: bool = False


def examine(
    given: GreyBoxModel | type[GreyBoxModel], starts: Callable[[GreyBoxModel], Collection[Points]] | None = None
) -> Examination:
    """Examine a class, or the class and the values of an object; its equations are run on made-up values.

    Args:
        starts: where simulations begin by the data, which say so better than the model; none where they do not fit it.
    """
    made = given if isinstance(given, type) else type(given)
    source = source_of(made)
    if odd := list(not_declared(made, source)):  # nothing else can be read
        return Examination(made, None, in_order(odd))
    found = [*missing_methods(made, source), *unusable_names(made, source), *port_signals(made, source)]
    code, names = _read(made, source)
    found += names
    if twice := list(declared_twice(made, source)):  # no object of it can be made
        return Examination(made, None, in_order([*found, *twice]))
    try:
        model = made() if isinstance(given, type) else given
    except Exception as error:  # the class may do anything when an object of it is made
        told = str(error) if isinstance(error, UserError) else f"creating it raised {type(error).__name__}: {error}"
        found.append(
            Finding("error", "declaration", told, "a class of which an object can be made", source.file, source.line)
        )
        return Examination(made, None, in_order(found))
    found += [*unreadable_units(model, source), *no_ports(made, source), *negative_masses(model, source)]
    if any(f.level == "error" for f in found):  # running the equations would repeat it, one at a time
        return Examination(made, model, in_order([*found, *code]))
    return _run(made, model, source, found, code, starts)


def _read(made: type[GreyBoxModel], source: Source) -> tuple[list[Finding], list[Finding]]:
    """What the text of the equations shows: code that will hardly run, and names."""
    code: list[Finding] = []
    names: list[Finding] = []
    declared = declared_names(made)
    for method in source.methods:
        items = made.states if method.name == "derivative" else made.outputs
        code += untraceable(method)
        unknown = list(unknown_names(method, declared))
        exchanged = exchanged_arguments(method, bool(unknown))
        names += unknown if exchanged is None else [exchanged]
        names += left_out(method, [item.name for item in items], {item.name: item.unit for item in items})
    return code, names


def _run(
    made: type[GreyBoxModel],
    model: GreyBoxModel,
    source: Source,
    found: list[Finding],
    code: list[Finding],
    starts: Callable[[GreyBoxModel], Collection[Points]] | None,
) -> Examination:
    wrong = list(fails(model, source))
    graph, uncompiled = (None, []) if wrong else compiled(model, source)
    if any(f.level == "error" for f in (*wrong, *uncompiled)):
        return Examination(made, model, in_order([*found, *(code or [*wrong, *uncompiled])]))
    found += uncompiled
    if graph is not None:
        found += [*misfits(model, graph, source), *missing_factors(model, graph, source)]
    points = points_of(model)
    try:
        moved = acting = influence(model, points)
        if not moved.finite.any():
            acting = influence(model, wide_points(model))
    except Exception as error:  # equations that run, and whose derivative does not
        found.append(told(raised(model, error), source, "functions that torch can differentiate", "warning"))
        return Examination(made, model, in_order(found), None, graph is not None)
    if not acting.finite.any():  # what moves an output cannot be seen either
        found.append(never_finite(model, points, starts(model) if starts else [start_of(model, {})], source))
        return Examination(made, model, in_order(found), None, graph is not None)
    found += [*without_effect(model, acting, graph, source), *not_finite(model, moved, points, source)]
    found += heat_against_the_fall(model, points, source)
    # pushed, negative masses go the other way by themselves, whatever the sign of their port
    found += turned_ports(model, with_masses_above_zero(model, points), source)
    found += rates_of_places(model, points, source)
    found += not_finite_at_start(model, source) if starts is None else ()
    return Examination(made, model, in_order(found), acting, graph is not None)
