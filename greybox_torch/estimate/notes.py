"""What is to be known of an optimum beside that it is one."""

from __future__ import annotations

import math
from collections.abc import Sequence

from greybox_torch.estimate.identifiability import Unidentifiable
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.termination import Outcome, Termination
from greybox_torch.name_lists import listed

_ROUNDED = 1e-9


def notes(problem: Problem, unidentifiable: Sequence[Unidentifiable]) -> tuple[Outcome, ...]:
    """Whether the data leave some of the free parameters undetermined, and whether some ended at a bound; which ones."""
    lost = {name for one in unidentifiable if one.undetermined for name in one.parameters}
    at_bound = at_bounds(problem)
    found = []
    if lost:
        found.append(
            Outcome(Termination.rank_deficient, listed([n for n in problem.free_names if n in lost] or sorted(lost)))
        )
    if at_bound:
        found.append(Outcome(Termination.at_bound, listed(at_bound)))
    return tuple(found)


def told_at_bound(names: str) -> str:
    """What a reader has to know of parameters at their bounds, one sentence and another, without a full stop."""
    return (
        f"At a bound: {names}; the standard deviations there mean little. Where physics does not end there, the model lacks something that "
        "drives the parameter there, or the data hardly determine it beside those that it is correlated with"
    )


def at_bounds(problem: Problem) -> list[str]:
    """The free parameters whose value is one of their bounds, but for rounding."""
    bounds = zip(problem.names, problem.free, problem.values, problem.lower, problem.upper, strict=True)
    return [name for name, free, *placed in bounds if free and at_a_bound(*placed)]


def at_a_bound(value: float, lower: float, upper: float) -> bool:
    """Whether a value is one of its bounds, but for rounding: 0.010000000000000004 is at 0.01."""
    return any(math.isclose(value, bound, rel_tol=_ROUNDED) for bound in (lower, upper))
