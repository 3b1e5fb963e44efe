"""How far a signal goes by what sensors show.

A model that lacks something goes elsewhere than the machine: without play it holds the two ends of a coupling together, without a stop it
runs past where the machine turns back. What may be the sensors' noise does not count.
"""

from __future__ import annotations

import numpy as np
import torch

from greybox_torch.estimate.problem import Problem
from greybox_torch.mechanisms.surroundings import Range
from greybox_torch.model import GreyBoxModel, Signals
from greybox_torch.model.ports import Signal
from greybox_torch.model.sensed_states import sensed_states

AVERAGED = 5
"""Samples that are averaged, which takes off half of the noise."""

NOISE_AT_MOST = 4.0
"""Standard deviations of the noise that do not count as motion."""

FEWEST = 4 * AVERAGED
"""Samples from which a range is taken from measurements."""


def as_measured(model: GreyBoxModel, signal: Signal, x: Signals, u: Signals, problem: Problem) -> np.ndarray:
    """A signal (N,) of states that sensors show, as they show them; NaN where a measurement is missing.

    Args:
        x: states (N,) along the records by name, of which those that sensors show are replaced.
    """
    shown, rows = sensed_states(model), {o.name: y for o, y in zip(model.outputs, problem.records.y, strict=True)}
    seen = x.replaced(**{s: torch.as_tensor(rows[output]) for s, output in shown.items()})
    values = seen[signal] if isinstance(signal, str) else signal(seen, u, problem.parameter_tensors)
    return np.broadcast_to(np.asarray(values, dtype=float), problem.records.y.shape[1:])


def farther(simulated: Range, measured: np.ndarray) -> Range:
    """The range that takes in ``measured`` (N,) as well, noise aside; NaN is missing."""
    ends = _ends(_averages(measured), noise_of(measured) / np.sqrt(AVERAGED))
    if ends is None:
        return simulated
    return Range(min(simulated.low, ends[0]), max(simulated.high, ends[1]), simulated.rms)


def no_farther(simulated: Range, measured: np.ndarray) -> Range:
    """The range of ``measured`` (N,), noise aside, in the place of the simulated one; NaN is missing."""
    noise = noise_of(measured)
    known = measured[np.isfinite(measured)]
    averages, samples = _ends(_averages(measured), noise / np.sqrt(AVERAGED)), _ends(known, noise)
    if averages is None or samples is None:
        return simulated
    # Averages cut off the ends of a fast motion, samples lose more of a slow one to the noise.
    low, high = min(averages[0], samples[0]), max(averages[1], samples[1])
    return Range(low, high, float(np.sqrt(np.mean(known**2)))) if low < high else simulated


def noise_of(measured: np.ndarray) -> float:
    """The standard deviation of white noise in measurements (N,): zero where they are too few to tell."""
    known = measured[np.isfinite(measured)]
    if len(known) < FEWEST:
        return 0.0
    # the variance of third differences of white noise is 20 times its own; the median leaves jumps out
    return 1.4826 * float(np.median(np.abs(np.diff(known, 3)))) / np.sqrt(20.0)


def _averages(measured: np.ndarray) -> np.ndarray:
    """Means over successive measurements, without those that are missing; none where they are few."""
    known = measured[np.isfinite(measured)]
    whole = len(known) // AVERAGED * AVERAGED
    return known[:whole].reshape(-1, AVERAGED).mean(axis=1) if whole >= FEWEST else known[:0]


def _ends(values: np.ndarray, noise: float) -> tuple[float, float] | None:
    """The lowest and the highest of some values, less what may be noise; None where there are none."""
    if not len(values):
        return None
    return float(values.min()) + NOISE_AT_MOST * noise, float(values.max()) - NOISE_AT_MOST * noise
