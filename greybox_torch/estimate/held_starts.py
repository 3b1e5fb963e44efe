"""Start states that the model file holds and the machine does not begin with.

A model whose twists begin at zero is right where every recording begins at rest. Cut out of a motion, a recording begins with a twist, and
parameters make up for that without a word. Seen: complete robot arms, estimated with 0.2 rad/s where 0.0034 is left once the twists are
estimated.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from greybox_torch.data import DataSet
from greybox_torch.estimate.free_run import FreeRun, descended
from greybox_torch.estimate.levenberg_marquardt import ROUGH
from greybox_torch.estimate.problem import Problem, all_starts_free
from greybox_torch.estimate.simulators import fine_enough
from greybox_torch.estimate.through_windows import FAR_ABOVE, from_windows, through_windows
from greybox_torch.simulation.simulator import Simulator

FAR_LESS = 0.5
"""Share of the error that is left, at most, where start states are told."""


@dataclass(frozen=True)
class HeldStarts:
    """The ``states`` that a model holds at their start values, and the share of the root mean square error that is left, ``left``, once
    they are estimated."""

    states: tuple[str, ...]
    left: float


def held_starts(data: DataSet, found: Problem, mean_square: float, simulator: Simulator) -> HeldStarts | None:
    """The start states that the model file holds and the card does not mention, where far less is left with them estimated; else None.

    Asked only where windows with free start states leave far less than whole records.

    Args:
        found: the estimate, and the mean squared weighted error that it leaves.
    """
    freed = all_starts_free(data, found)
    more = freed.initial_free & ~found.initial_free
    if not more.any():
        return None
    left = min(_lefts(freed, mean_square, simulator), default=mean_square)
    share = (left / mean_square) ** 0.5 if mean_square > 0.0 else 1.0
    if share > FAR_LESS:
        return None
    names = tuple(s.name for s, one in zip(freed.model.states, more, strict=True) if one)
    return HeldStarts(names, share)


def _lefts(freed: Problem, mean_square: float, simulator: Simulator) -> Iterator[float]:
    """Mean squared errors of whole records from the values of ``freed`` and from those that its windows lead to."""
    simulator = fine_enough(simulator, freed)
    begun = [freed]
    for fit in through_windows(freed, simulator):
        if mean_square <= FAR_ABOVE**2 * fit.mean_square:
            return
        begun.append(from_windows(fit))
    for problem in begun:
        run = FreeRun(problem, simulator)
        optimum = descended(run, run.start, ROUGH)
        if optimum is not None:
            yield 2 * optimum.model.cost / problem.samples
