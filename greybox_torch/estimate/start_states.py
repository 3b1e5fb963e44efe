"""The start states of a problem by name."""

from __future__ import annotations

from greybox_torch.estimate.problem import Problem


def starts_of(problem: Problem) -> dict[str, dict[str, float]]:
    """By recording and state, in the states' units."""
    names = [s.name for s in problem.model.states]
    return {
        e: dict(zip(names, map(float, row), strict=True))
        for e, row in zip(problem.records.names, problem.initial, strict=True)
    }
