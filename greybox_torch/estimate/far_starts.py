"""Estimated start states that lie far from the sample that shows them: a sign that they make up for what the model lacks."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from greybox_torch.estimate.measured_range import noise_of
from greybox_torch.estimate.problem import Problem
from greybox_torch.in_unit import in_unit
from greybox_torch.model.sensed_states import sensed_states
from greybox_torch.name_lists import further

NOISE_AT_MOST = 6.0
"""Standard deviations of a sensor's noise that a start state may lie from the first sample."""

RESOLUTION = 2.0
"""Steps of a sensor that it may lie from it: where it counts, its noise may be none."""

_SHOWN = 3  # experiments that are named

RANGE = 0.005
"""Share of what the sensor shows in the experiment below which a difference is not worth a word."""


def far_starts(problem: Problem, given: Collection[str] = (), *, share: float = RANGE) -> list[str]:
    """A sentence without its full stop for every experiment in which estimated start states that an output shows, and that are declared
    ``initial="measured"``, are not where the first sample is, farther than the sensor's noise explains.

    Where the first sample is missing nothing is said: the next one may be anywhere.

    Args:
        given: states that the card gives a start value, so that they are not to begin as measured.
        share: of what the sensor shows in the experiment, up to which a difference is not told.
    """
    records, model = problem.records, problem.model.plain
    shown = sensed_states(model)
    told = []
    for e, name in enumerate(records.names):
        far = []
        for i, state in enumerate(model.states):
            if state.initial != "measured" or state.name not in shown or not problem.initial_free[i]:
                continue
            if state.name in given:
                continue
            values = records.y[[o.name for o in model.outputs].index(shown[state.name]), records.span(e)]
            sample, noise = float(values[0]), noise_of(values)
            if np.isfinite(sample) and abs(problem.initial[e, i] - sample) > _at_most(values, noise, share):
                far.append(in_unit(f"{state.name} at {problem.initial[e, i]:.4g}", state.unit) + _beside(sample, noise))
        if far:
            told.append(f"{name} is begun with {', '.join(far)}")
    return told


def told_far(far: Sequence[str], *, estimated: bool = True) -> str:
    """What a reader has to know of :func:`far_starts`, without a full stop.

    Args:
        estimated: whether parameters were estimated with these start states, and so are no reason for them.
    """
    parameters = "" if estimated else ", or for parameters that are not the machine's"
    more = f"; and {further(len(far) - _SHOWN, 'experiment')}" if len(far) > _SHOWN else ""
    return (
        f"{'; '.join(far[:_SHOWN])}{more}: farther from the first sample than the sensor's noise explains, though the state is declared to "
        f"begin as measured. Such a start may make up for something that the model lacks or has wrong{parameters}; "
        "[model.initial] name = { fixed = true } on the card holds a state at its first sample"
    )


def _beside(sample: float, noise: float) -> str:
    spread = f" ± {noise:.1g}" if noise > 0.0 else ""
    return f" (first sample {sample:.4g}{spread})"


def _at_most(values: np.ndarray, noise: float, share: float) -> float:
    """How far a start state may lie from the first sample of measurements (N,) with some noise."""
    known = values[np.isfinite(values)]
    steps = np.abs(np.diff(known))
    step = float(steps[steps > 0.0].min()) if (steps > 0.0).any() else 0.0
    return max(NOISE_AT_MOST * noise, RESOLUTION * step, share * float(np.ptp(known)))
