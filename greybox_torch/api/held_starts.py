"""Start states that the model file holds, where recordings begin elsewhere: what a reader is told."""

from __future__ import annotations

from typing import Any

from greybox_torch.estimate.held_starts import HeldStarts
from greybox_torch.estimate.problem import Problem
from greybox_torch.in_unit import in_unit
from greybox_torch.name_lists import listed


def told_held(held: HeldStarts, problem: Problem) -> str:
    """A sentence for the reader of an estimate, whose ``problem`` has the values at which they are held."""
    by_name = {s.name: (problem.initial[0, i], s.unit) for i, s in enumerate(problem.model.states)}
    begun = listed([in_unit(f"{name} at {by_name[name][0]:.4g}", by_name[name][1]) for name in held.states])
    entries = ", ".join(f"{name} = {{ fixed = false }}" for name in held.states)
    return (
        f"The model file begins {begun}, and holds it there. Estimated instead for every experiment, {100 * held.left:.2g} % of the error "
        "is left: the recordings do not begin so, and parameters make up for it. Let start states be estimated on the card: "
        f"[model.initial] {entries}"
    )


def held_json(held: HeldStarts) -> dict[str, Any]:
    """The same for a program: ``states``, and the share of the root mean square error that is ``left`` with them estimated."""
    return {"states": list(held.states), "left": held.left}
