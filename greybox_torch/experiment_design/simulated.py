"""Inputs simulated side by side under every hypothesis, and whether all of them keep the limits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from greybox_torch.experiment_design.contender import Contender, records_of
from greybox_torch.experiment_design.limits import Limits, Range
from greybox_torch.simulation.records import Records

MOST_NUMBERS = 20_000_000
"""Derivatives that are kept at a time."""


def within(
    contenders: Sequence[Contender], limits: Limits, inputs: Sequence[np.ndarray], time: np.ndarray
) -> list[bool]:
    """Whether outputs and states stay within the limits under every hypothesis, for each of some inputs."""
    fine = np.ones(len(inputs), dtype=bool)
    for one in contenders:
        for chunk in chunks(len(inputs), len(time) * (len(one.level) + len(one.problem.model.states))):
            found = one.predicted(input_records(one, inputs[chunk], time), tangents=False)
            fine[chunk] &= _inside(found.y, [o.name for o in one.problem.model.outputs], limits.outputs)
            fine[chunk] &= _inside(found.states, [s.name for s in one.problem.model.states], limits.states)
    return [bool(f) for f in fine]


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
