"""Inputs simulated side by side under every hypothesis, and whether all of them keep the limits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from greybox_torch.experiment_design.contender import Contender, Prediction
from greybox_torch.experiment_design.limits import Limits, Range
from greybox_torch.experiment_design.side_by_side import records_of
from greybox_torch.simulation.records import Records

MOST_NUMBERS = 20_000_000
"""Derivatives that are kept at a time."""


def within(
    contenders: Sequence[Contender], limits: Limits, commands: Sequence[np.ndarray], time: np.ndarray
) -> list[bool]:
    """Whether outputs and states stay within the limits under every hypothesis, and inputs that a loop drives, for each of some commands.

    Args:
        commands: inputs, and set points of those that a loop drives, (n_u, N) each.
    """
    fine = np.ones(len(commands), dtype=bool)
    for one in contenders:
        for chunk in chunks(len(commands), len(time) * (len(one.level) + len(one.problem.model.states))):
            inputs = one.driven(commands[chunk], float(time[1] - time[0]))
            fine[chunk] &= keeps(one, limits, inputs, time)
    return [bool(f) for f in fine]


def predictions(
    contenders: Sequence[Contender], commands: Sequence[np.ndarray], time: np.ndarray
) -> list[list[Prediction]]:
    """For each hypothesis, what all of them predict, with slopes, on the inputs that reach the machine if it is right."""
    if not contenders[0].loops:
        return [[one.predicted(input_records(one, commands, time)) for one in contenders]] * len(contenders)
    along = []
    for right in contenders:
        inputs = right.driven(commands, float(time[1] - time[0]))
        along.append([one.predicted(input_records(one, inputs, time)) for one in contenders])
    return along


def keeps(
    one: Contender,
    limits: Limits,
    inputs: Sequence[np.ndarray],
    time: np.ndarray,
    values: np.ndarray | None = None,
) -> np.ndarray:
    """Whether a hypothesis keeps the limits, (C,), on inputs (n_u, N) that reach the machine, with other parameters (C, n_p) on each."""
    found = one.predicted(input_records(one, inputs, time), tangents=False, values=values)
    fine = _inside(found.y, [o.name for o in one.problem.model.outputs], limits.outputs)
    fine &= _inside(found.states, [s.name for s in one.problem.model.states], limits.states)
    names = [i.name for i in one.problem.model.inputs]
    for loop in one.loops:
        own = limits.inputs[names[loop.driven]]
        u = np.array([row[loop.driven] for row in inputs])
        fine &= _inside(u[..., None], names[loop.driven : loop.driven + 1], limits.inputs)
        with np.errstate(invalid="ignore"):
            fine &= (np.abs(np.diff(u, axis=1)) <= own.rate * float(time[1] - time[0])).all(axis=1)
    return fine


def _inside(values: np.ndarray, names: Sequence[str], limits: Mapping[str, Range]) -> np.ndarray:
    """Whether each record's signals (C, N, n) are finite and within their limits, (C,)."""
    fine: np.ndarray = np.array([np.isfinite(one).all() for one in values])
    for k, name in enumerate(names):
        if name in limits:
            low, high = limits[name].lower, limits[name].upper
            with np.errstate(invalid="ignore"):
                fine &= ((values[..., k] >= low) & (values[..., k] <= high)).all(axis=1)
    return fine


def input_records(one: Contender, inputs: Sequence[np.ndarray], time: np.ndarray) -> Records:
    """The records of some inputs (n_u, N), for one of the hypotheses."""
    return records_of(inputs, one.problem.records, float(time[1] - time[0]))


def chunks(count: int, numbers_each: int) -> list[slice]:
    """Slices of at most as many records as keep the memory small."""
    size = max(1, MOST_NUMBERS // max(1, numbers_each))
    return [slice(k, min(k + size, count)) for k in range(0, count, size)]
