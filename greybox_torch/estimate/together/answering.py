"""Descents of many machines, the passes that they ask for made together."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from greybox_torch.estimate.levenberg_marquardt import Allowed, Descending, Evaluated, Optimum
from greybox_torch.estimate.together.free_runs import FreeRuns


def answered_together(runs: FreeRuns, descents: Mapping[int, Descending[None]]) -> dict[int, Optimum[None] | None]:
    """Where the descents of some machines end, the questions of all answered together, turn by turn."""
    ended: dict[int, Optimum[None] | None] = {}
    asked: dict[int, Allowed | Evaluated] = {}

    def go_on(machine: int, answer: Any) -> None:
        try:
            asked[machine] = descents[machine].send(answer)
        except StopIteration as end:
            asked.pop(machine, None)
            ended[machine] = end.value

    for m in descents:
        go_on(m, None)
    while asked:
        # Constraints first: they cost next to nothing, and a step that is shortened asks again before it is simulated.
        limits = {m: a.point for m, a in asked.items() if isinstance(a, Allowed)}
        answers = runs.allowed(limits) if limits else runs.quadratics({m: a.point for m, a in asked.items()})
        for m, answer in answers.items():
            go_on(m, answer)
    return ended
