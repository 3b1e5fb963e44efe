"""Where a simulation overflows, and which start values avoid it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from greybox_torch.errors import NumericalError
from greybox_torch.estimate.free_run import simulate
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.termination import Outcome, Termination
from greybox_torch.in_unit import in_unit
from greybox_torch.name_lists import listed
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import Windows

FACTORS = (0.5, 2.0, 0.1, 10.0, 1e-2, 1e2, 1e-3, 1e3, 0.0, -1.0)
"""What a parameter's value is multiplied by in search of one with which the simulation stays finite, the nearest first."""

LARGEST = float(np.sqrt(np.finfo(float).max))
"""Size of an output from which its squared error is no number."""

HARDLY_LARGER = 100.0
"""Times the largest measured value up to which a simulation has not run away."""

NO_NUMBER = (
    "no number (nan) with nothing large before it, as the root or logarithm of a negative number is, or 0/0; greybox check says in which "
    "line of the equations"
)
"""What is said of outputs that cease to be numbers without having grown."""

LANES = 64
"""How many experiments are simulated side by side at most while searching: whole records take memory."""


@dataclass(frozen=True)
class Overflow:
    """The first output whose square is not finite: in which experiment, how many s after its first sample, at which sample of it.

    ``no_number``: whether it is no number (nan) at once, after values that are not large: the equations took the root or the logarithm of a
    negative number, or divided zero by zero.
    """

    experiment: str
    time: float
    sample: int
    no_number: bool = False


@dataclass(frozen=True)
class Suggestion:
    """One parameter's value with which all experiments are simulated to their end."""

    name: str
    value: float
    before: float
    unit: str

    def __str__(self) -> str:
        return f"{self.name} = {in_unit(f'{self.value:.5g}', self.unit)} (now {self.before:.5g})"


def overflows(problem: Problem, simulated: Sequence[np.ndarray]) -> tuple[Overflow, ...]:
    """Where the simulated outputs (N_e, n_y) or their squares cease to be finite, in every experiment in which they do."""
    found = []
    for e, values in enumerate(simulated):
        broken = np.flatnonzero(~_countable(values).all(axis=1))
        if broken.size:
            sample = int(broken[0])
            time, at_once = float(problem.records.time(e)[sample]), _no_number(problem, e, values[: sample + 1])
            found.append(Overflow(problem.records.names[e], time, sample, at_once))
    return tuple(found)


def _no_number(problem: Problem, experiment: int, values: np.ndarray) -> bool:
    """Whether the last of some outputs (n, n_y) is nan where those before it are hardly larger than what was measured."""
    if len(values) < 2 or not np.isnan(values[-1]).any():
        return False
    y = np.abs(problem.records.y[:, problem.records.span(experiment)])
    largest = np.max(np.where(np.isnan(y), 0.0, y), axis=1)
    return bool((np.abs(values[-2]) <= HARDLY_LARGER * largest).all())


def _countable(values: np.ndarray) -> np.ndarray:
    """Whether the square of a value is a number, so that an error of that size has a mean square."""
    return np.abs(values) < LARGEST


def suggestions(problem: Problem, simulator: Simulator) -> tuple[Suggestion, ...]:
    """Parameter values, one changed at a time and within its bounds, with which no experiment overflows: the nearest to the present ones.

    Tried on the free parameters, or on all where none is free; empty where no single one helps. One that is zero stays so with any factor:
    in its place the model's own value is tried at last, or one; and where no free one helps, that of the fixed ones that are zero, as a
    heat capacity of 0 may be.
    """
    tried = np.flatnonzero(problem.free) if problem.free.any() else np.arange(len(problem.names))
    zero, declared = problem.values == 0.0, [p.value for p in problem.model.declared_parameters]
    scaled = [[(int(k), factor * float(problem.values[k])) for k in tried if not zero[k]] for factor in FACTORS]
    own = {int(k): declared[k] if np.isfinite(declared[k]) and declared[k] else 1.0 for k in np.flatnonzero(zero)}
    zeros = [[(k, value) for k, value in own.items() if (k in tried) == first] for first in (True, False)]
    for candidates in (*scaled, *zeros):
        rows = [_changed(problem, k, value) for k, value in candidates]
        allowed = [i for i, row in enumerate(rows) if _allowed(problem, row)]
        finite = _finite(problem, simulator, np.array([rows[i] for i in allowed])) if allowed else []
        units = {p.name: p.unit for p in problem.model.declared_parameters}
        found = tuple(
            Suggestion(problem.names[k], value, float(problem.values[k]), units[problem.names[k]])
            for (k, value), good in zip([candidates[i] for i in allowed], finite, strict=True)
            if good
        )
        if found:
            return found
    return ()


def avoidance(found: Sequence[Suggestion]) -> str:
    """The suggestions as a clause."""
    if not found:
        return (
            f"changing one parameter alone, by up to {max(FACTORS):g} times, does not avoid it: "
            "check units, scales and signs in the card and in the equations"
        )
    return f"it does not with {listed([str(suggestion) for suggestion in found[:3]], 'or')}"


def overflow_error(doing: str, problem: Problem, simulator: Simulator) -> NumericalError:
    """The error to raise where the whole records overflow: when, in which experiment, and which start values avoid it.

    Args:
        doing: "estimating" or "simulating".
    """
    found = overflows(problem, simulate(problem, simulator))
    if not found:  # the outputs are finite, and their sensitivities are not
        detail = "the outputs stay finite, their sensitivities do not"
    else:
        where = f"at t = {found[0].time:.6g} s in '{found[0].experiment}'"
        where += f", {NO_NUMBER}" if found[0].no_number else ""
        detail = f"{where}; {avoidance(suggestions(problem, simulator))}"
    return NumericalError(f"{doing} {problem.model.title}: {Outcome(Termination.overflow, detail).sentence}")


def _changed(problem: Problem, k: int, value: float) -> np.ndarray:
    row = problem.values.copy()
    row[k] = value
    return row


def _allowed(problem: Problem, row: np.ndarray) -> bool:
    inside = (row >= problem.lower) & (row <= problem.upper)
    return bool(inside.all()) and problem.admissible(row)


def _finite(problem: Problem, simulator: Simulator, rows: np.ndarray) -> np.ndarray:
    """Which of the parameter sets (C, n_p) simulate every experiment to its end, (C,)."""
    records, count = problem.driving_records, len(problem.records.first)
    together = max(1, LANES // count)
    result = []
    for begin in range(0, len(rows), together):
        part = rows[begin : begin + together]
        windows = Windows(
            np.tile(records.first, len(part)), np.tile(records.last, len(part)), int(records.lengths.max())
        )
        starts = np.tile(problem.initial, (len(part), 1))
        y = simulator.run(records, Pass(windows, np.repeat(part, count, axis=0), starts)).y
        inside = np.arange(y.shape[1]) < np.tile(records.lengths, len(part))[:, None]
        good = (_countable(y).all(axis=2) | ~inside).all(axis=1)
        result += good.reshape(len(part), count).all(axis=1).tolist()
    return np.array(result)
