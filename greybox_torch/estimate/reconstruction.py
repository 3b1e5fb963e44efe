"""The motion of a machine as its sensors alone show it: states along the recordings, without simulating anything.

A measured state is its output, smoothed; a hidden one follows from the slopes of measured ones, as the speed behind a position does. Where
a state is neither, and something depends on it, nothing can be said without a simulation.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from greybox_torch.estimate.kinematics import Kinematics, kinematics_of
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.smoothing import band, half_width, smoothed
from greybox_torch.model.sensed_states import sensed_states
from greybox_torch.simulation.records import Records

PER_STRETCH = 4
"""Intervals within half a period of the highest frequency that rates are seen at: closer ones say nothing more."""

MOST_INTERVALS = 40_000
"""Of all records together."""


@dataclass(frozen=True)
class Motion:
    """States and their rates over N successive intervals of some records, each of one or more samples.

    ``states`` (n_x, N) and ``inputs`` (n_u, N), means over the interval; ``rates`` (n_x, N), what the states change by over it, divided by
    its length; ``dt`` (N,) its length and ``time`` (N,) its middle since the start of the ``experiment`` (N,) by index, in s; ``known``
    (N,), whether the sensors show it; ``shown`` (n_x,), which states sensors show (the others, which nothing depends on, are zero here);
    ``cutoff``, the frequency in cycles per interval up to which all rates stand above the sensors' noise.
    """

    states: np.ndarray
    rates: np.ndarray
    inputs: np.ndarray
    dt: np.ndarray
    time: np.ndarray
    experiment: np.ndarray
    known: np.ndarray
    shown: np.ndarray
    cutoff: float

    def integrated(self, rates: np.ndarray, start: np.ndarray) -> np.ndarray:
        """What ``rates`` (k, N) integrate to in the middle of the intervals (k, N), every experiment from its ``start`` (E, k)."""
        moved, path = rates * self.dt, np.empty_like(rates)
        for e in np.unique(self.experiment):
            own = self.experiment == e
            path[:, own] = start[e][:, None] + np.cumsum(moved[:, own], axis=1) - 0.5 * moved[:, own]
        return path


def reconstructed(problem: Problem, driven: Mapping[int, np.ndarray] = MappingProxyType({})) -> Motion | str:
    """The motion that the outputs of a problem show; a clause that says why where they do not show it.

    Args:
        driven: states (N,) at the samples that inputs alone drive, by index: they need no sensor.
    """
    model, records = problem.model.plain, problem.records
    sensed, outputs = sensed_states(model), [o.name for o in model.outputs]
    shown = {i: outputs.index(sensed[s.name]) for i, s in enumerate(model.states) if s.name in sensed}
    relations = kinematics_of(model)
    hidden = [] if relations is None else list(relations.hidden[relations.determined])
    unseen = model.carried_states()
    known = {*shown, *hidden, *driven}
    left = [s.name for i, s in enumerate(model.states) if i not in known and s.name not in unseen]
    if left or not shown:
        return f"no output shows {', '.join(left) or 'a state'}, or a rate that it follows from"
    missing = np.isnan(records.y)
    if any(missing[:, records.span(e)].all(axis=1).any() for e in range(len(records.first))):
        return "an output is missing throughout an experiment"
    whole = np.array([_filled(records, row) for row in records.y])
    cutoffs = np.array([_band(records, row) for row in whole])
    if not (cutoffs > 0).all():
        return "an output does not stand above its noise"
    at_samples, measured = np.zeros((2, len(model.states), whole.shape[1]))
    for i, k in shown.items():
        at_samples[i], measured[i] = _smoothed(records, whole[k], float(cutoffs[k])), whole[k]
    for i in set(driven) - {*shown, *hidden}:
        at_samples[i] = measured[i] = driven[i]
    if relations is not None:
        slopes = np.array([_slope(records, whole[k], float(cutoffs[k])) for k in relations.outputs])
        at_samples[hidden] = measured[hidden] = _hidden(relations, slopes, at_samples, records)[relations.determined]
    there = np.asarray(~missing.any(axis=0))
    if not there.all():
        widest = half_width(float(cutoffs.min()), whole.shape[1])
        there = np.convolve(~there, np.ones(2 * widest + 1), "same") < 0.5  # smoothing takes in what is beside
    shown_states = np.array(sorted({*shown, *hidden, *driven}))
    return _between(records, at_samples, measured, there, shown_states, float(cutoffs.min()))


def _hidden(relations: Kinematics, slopes: np.ndarray, states: np.ndarray, records: Records) -> np.ndarray:
    """The hidden states (n_hidden, N) that slopes (K, N) of measured signals tell."""
    rest = slopes - relations.known @ states[relations.measured] - relations.inputs @ records.u
    return relations.inverse @ (rest - relations.constant[:, None])


def _between(
    records: Records, states: np.ndarray, measured: np.ndarray, known: np.ndarray, shown: np.ndarray, cutoff: float
) -> Motion:
    """The motion over intervals, from ``states`` (n_x, N) at the samples and what their rates are taken from, ``measured`` (n_x, N)."""
    samples = max(int(0.5 / cutoff) // PER_STRETCH, int(records.lengths.sum()) // MOST_INTERVALS + 1, 1)
    pairs = zip(records.first, records.last, strict=True)
    begin = np.concatenate([np.arange(a, b - samples + 1, samples) for a, b in pairs])
    inside, at = begin[:, None] + np.arange(samples), begin[:, None] + np.arange(samples + 1)
    share = records.dt[inside] / records.dt[inside].sum(axis=1, keepdims=True)
    held = records.u if records.hold == "zoh" else 0.5 * (records.u + np.roll(records.u, -1, axis=1))
    times = np.concatenate([records.time(e) for e in range(len(records.first))])
    dt = records.dt[inside].sum(axis=1)
    return Motion(
        states=(0.5 * (states[:, at[:, 1:]] + states[:, at[:, :-1]]) * share).sum(axis=2),
        rates=(measured[:, begin + samples] - measured[:, begin]) / dt,
        inputs=(held[:, inside] * share).sum(axis=2),
        dt=dt,
        time=times[begin] + 0.5 * dt,
        experiment=records.experiments(begin),
        known=np.asarray(known[at].all(axis=1)),
        shown=np.isin(np.arange(len(states)), shown),
        cutoff=min(0.5, cutoff * samples),
    )


def _filled(records: Records, y: np.ndarray) -> np.ndarray:
    """An output (N,) with gaps bridged by straight lines; what is in a gap is not used, but for smoothing what is beside it."""
    filled, at = y.copy(), np.arange(len(y))
    for e in range(len(records.first)):
        span = records.span(e)
        known = ~np.isnan(y[span])
        filled[span] = np.interp(at[span], at[span][known], y[span][known])
    return filled


def _band(records: Records, y: np.ndarray) -> float:
    """The widest band of any experiment: a record at rest shows none."""
    return max(band(y[records.span(e)]) for e in range(len(records.first)))


def _smoothed(records: Records, y: np.ndarray, cutoff: float) -> np.ndarray:
    return np.concatenate([smoothed(y[records.span(e)], cutoff) for e in range(len(records.first))])


def _slope(records: Records, y: np.ndarray, cutoff: float) -> np.ndarray:
    """The slope of an output per second; time stamps are taken as they are."""
    pieces = []
    for e in range(len(records.first)):
        span = records.span(e)
        rise = smoothed(y[span], cutoff, slope=True)
        pieces.append(rise / smoothed(records.time(e), cutoff, slope=True))
    return np.concatenate(pieces)
