"""How far a coupling deflects by what sensors at both of its ends show."""

from __future__ import annotations

import numpy as np
import torch

from greybox_torch.estimate.problem import Problem
from greybox_torch.mechanisms.surroundings import Range
from greybox_torch.model import Coupling, GreyBoxModel, Signals
from greybox_torch.model.sensed_states import sensed_states

AVERAGED = 5
"""Samples that are averaged, which takes off half of the noise."""

NOISE_AT_MOST = 4.0
"""Standard deviations of the averages' noise that do not count as deflection."""


def with_measured(
    simulated: Range, model: GreyBoxModel, port: Coupling, x: Signals, u: Signals, problem: Problem
) -> Range:
    """``simulated``, or farther, as the sensors show it.

    A model without play holds the two ends together by its spring where the machine lets them go: its deflection says less of the
    machine's than the sensors do. What may be their noise does not count.

    Args:
        x: states (N,) along the records by name, of which those that sensors show are replaced.
    """
    shown, rows = sensed_states(model), {o.name: y for o, y in zip(model.outputs, problem.records.y, strict=True)}
    states = {s: torch.as_tensor(rows[output]) for s, output in shown.items()}
    signal, seen = port.signals["deflection"], x.replaced(**states)
    values = seen[signal] if isinstance(signal, str) else signal(seen, u, problem.parameter_tensors)
    return farther(simulated, np.broadcast_to(np.asarray(values, dtype=float), problem.records.y.shape[1:]))


def farther(simulated: Range, measured: np.ndarray) -> Range:
    """The range that takes in ``measured`` (N,), noise aside; NaN is missing."""
    known = measured[np.isfinite(measured)]
    whole = len(known) // AVERAGED * AVERAGED
    if whole < 4 * AVERAGED:
        return simulated
    means = known[:whole].reshape(-1, AVERAGED).mean(axis=1)
    # the variance of third differences of white noise is 20 times its own; the median leaves jumps out
    noise = 1.4826 * float(np.median(np.abs(np.diff(known, 3)))) / np.sqrt(20.0)
    beyond = NOISE_AT_MOST * noise / np.sqrt(AVERAGED)
    low, high = float(means.min()) + beyond, float(means.max()) - beyond
    return Range(min(simulated.low, low), max(simulated.high, high), simulated.rms)
