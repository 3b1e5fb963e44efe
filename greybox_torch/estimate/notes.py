"""What is to be known of an optimum beside that it is one."""

from __future__ import annotations

import math
from collections.abc import Sequence

from greybox_torch.estimate.identifiability import Unidentifiable
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.termination import Outcome, Termination
from greybox_torch.in_unit import in_unit
from greybox_torch.name_lists import listed

_ROUNDED, _ROUNDED_ZERO = 1e-9, 1e-13


def notes(problem: Problem, unidentifiable: Sequence[Unidentifiable]) -> tuple[Outcome, ...]:
    """Whether the data leave some of the free parameters undetermined, and whether some ended at a bound; which ones."""
    lost = {name for one in unidentifiable if one.undetermined for name in one.parameters}
    at_bound = at_bounds(problem)
    placed = dict(zip(problem.names, zip(problem.values, problem.lower, problem.upper, strict=True), strict=True))
    units = {p.name: p.unit for p in problem.model.declared_parameters}
    found = []
    if lost:
        found.append(
            Outcome(Termination.rank_deficient, listed([n for n in problem.free_names if n in lost] or sorted(lost)))
        )
    if at_bound:
        found.append(
            Outcome(Termination.at_bound, listed([_with_bound(n, units.get(n, ""), *placed[n]) for n in at_bound]))
        )
    return tuple(found)


def with_value(name: str, value: float, unit: str) -> str:
    """A parameter with its value, as "b = 0.07 N m s/rad"."""
    return in_unit(f"{name} = {value:.4g}", unit)


def _with_bound(name: str, unit: str, value: float, lower: float, upper: float) -> str:
    bound = nearest_bound(value, lower, upper)
    assert bound is not None
    return in_unit(f"{name} {'≥' if bound == lower else '≤'} {bound:.4g}", unit)


def told_at_bound(names: str) -> str:
    """What a reader has to know of parameters at their bounds, without a full stop.

    Args:
        names: the parameters, with the bounds that they are at.
    """
    return (
        f"At a bound: {names}; the standard deviations there mean little. Where the machine has no such limit, the model lacks something, "
        "or the recordings do not tell the parameter from others"
    )


def told_law_at_bound(names: str) -> str:
    """What a reader has to know of parameters of a law of the library at their bounds, which are the law's own, without a full stop."""
    return f"At a bound of the law itself: {names}; the standard deviations of these parameters mean little"


def at_bounds(problem: Problem) -> list[str]:
    """The free parameters whose value is one of their bounds, but for rounding."""
    bounds = zip(problem.names, problem.free, problem.values, problem.lower, problem.upper, strict=True)
    return [name for name, free, *placed in bounds if free and at_a_bound(*placed)]


def at_a_bound(value: float, lower: float, upper: float) -> bool:
    """Whether a value is one of its bounds, but for rounding: 0.010000000000000004 is at 0.01, and 4e-13 of 40 at most is at 0."""
    return nearest_bound(value, lower, upper) is not None


def nearest_bound(value: float, lower: float, upper: float) -> float | None:
    """The bound that a value is at, but for rounding; None where it is at none. What is next to zero is told by the other bound."""
    for bound, other in ((lower, upper), (upper, lower)):
        near_zero = _ROUNDED_ZERO * abs(other) if bound == 0.0 and math.isfinite(other) else 0.0
        if math.isclose(value, bound, rel_tol=_ROUNDED, abs_tol=near_zero):
            return bound
    return None
