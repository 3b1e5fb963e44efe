"""How visible an effect is to whoever refits the plain model.

The recorded command is replayed on the plain machine at its true parameters, from the true state where the recording begins. What is
left is projected off everything that a refit could take up, to first order: the free parameters, shared by the four experiments,
and the start states of each. Its RMS, in units of the floor, is the visibility. The floor is the same for the run without effect: sensor
noise, read-out, jitter, and what is left of torque noise and drift.

The `sigma` of a key, above which error is to be closed, is what the true model itself leaves when it is judged as a verdict is:
true parameters, start states estimated on the first tenth of each experiment, free run over the whole of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiments.concealed.machines.base import LANES, Machine, Run, Trial

Array = NDArray[np.float64]

MODERATE, DOMINANT, OVERWHELMING = 6.0, 30.0, 200.0
"""Visibilities from which on an effect counts as moderate, as dominant, as overwhelming, whatever was aimed at."""
EVERY = 4
"""Samples from one to the next that the projection looks at."""
RELATIVE_STEP = 1e-4
MOST = 1e6
"""What a visibility is called at most, where the plain model is lost altogether."""


def word(visibility: float) -> str:
    """What the key calls it."""
    found = "weak"
    for name, least in (("moderate", MODERATE), ("dominant", DOMINANT), ("overwhelming", OVERWHELMING)):
        found = name if visibility >= least else found
    return found


def residuals(machine: Machine, trials: Sequence[Trial], runs: Sequence[Run]) -> list[Array]:
    """Recorded less replayed outputs of the plain machine at the true parameters, (outputs, samples, 4) for each trial."""
    width = LANES * len(trials)
    truth = {name: np.repeat([t.truth[name] for t in trials], LANES) for name in machine.parameters}
    command, start, recorded = _together(machine, runs)
    left = recorded - machine.replay(truth, start, command)
    return [left[:, :, i : i + LANES] for i in range(0, width, LANES)]


def sensitivities(machine: Machine, trials: Sequence[Trial], runs: Sequence[Run]) -> list[Array]:
    """By finite differences, of the outputs to the logarithms of the free parameters and to the start states.

    (columns, outputs, samples, 4) for each trial, every `EVERY`-th sample.
    """
    command, start, _ = _together(machine, runs)
    truth = {name: np.repeat([t.truth[name] for t in trials], LANES) for name in machine.parameters}
    names, steps = machine.free, machine.state_steps
    copies, lanes = 1 + len(names) + len(steps), start.shape[1]
    values = {name: np.tile(truth[name], copies) for name in machine.parameters}
    starts = np.tile(start, copies)
    for i, name in enumerate(names, start=1):
        values[name][lanes * i : lanes * (i + 1)] *= 1.0 + RELATIVE_STEP
    for i, step in enumerate(steps):
        first = lanes * (1 + len(names) + i)
        starts[i, first : first + lanes] += step
    shown = machine.replay(values, starts, np.tile(command, copies))[:, ::EVERY]
    parts = shown.reshape(*shown.shape[:2], copies, lanes)
    size = np.array([*[RELATIVE_STEP] * len(names), *steps])
    slopes = (np.moveaxis(parts[:, :, 1:], 2, 0) - parts[None, :, :, 0]) / size[:, None, None, None]
    return [slopes[..., LANES * i : LANES * (i + 1)] for i in range(len(trials))]


def unexplained(residual: Array, columns: Array, parameters: int, weights: Array) -> Array:
    """What is left of residual (outputs, samples, 4), every `EVERY`-th sample of it, beside the columns (columns, outputs, samples, 4).

    The first `parameters` columns are shared by the four experiments, the others are each experiment's own. `weights` (outputs,)
    make the outputs comparable.
    """
    thin = residual[:, ::EVERY] * weights[:, None, None]
    scaled = columns * weights[None, :, None, None]
    outputs, samples, _ = thin.shape
    shared, rests = [], []
    for j in range(LANES):
        own = scaled[parameters:, :, :, j].reshape(len(columns) - parameters, -1).T
        basis, _ = np.linalg.qr(own / np.linalg.norm(own, axis=0))
        target = np.concatenate([thin[:, :, j].reshape(1, -1), scaled[:parameters, :, :, j].reshape(parameters, -1)]).T
        target = target - basis @ (basis.T @ target)
        rests.append(target[:, 0])
        shared.append(target[:, 1:])
    rest, design = np.concatenate(rests), np.concatenate(shared)
    size = np.linalg.norm(design, axis=0)
    solution = np.linalg.lstsq(design / size, rest, rcond=1e-10)[0]
    left = rest - design / size @ solution
    return np.moveaxis(left.reshape(LANES, outputs, samples), 0, 2) / weights[:, None, None]


def free_run(residual: Array, states: Array, weights: Array) -> Array:
    """Residual (outputs, samples, 4), every `EVERY`-th sample of it, once the start states are fitted on its first tenth.

    `states`: sensitivities to the start states (states, outputs, samples, 4); `weights` (outputs,) make the outputs comparable.
    """
    left = residual[:, ::EVERY].copy()
    first = max(left.shape[1] // 10, len(states))
    for j in range(LANES):
        design = (states[:, :, :first, j] * weights[None, :, None]).reshape(len(states), -1).T
        target = (left[:, :first, j] * weights[:, None]).ravel()
        size = np.linalg.norm(design, axis=0)
        solution = np.linalg.lstsq(design / size, target, rcond=1e-10)[0] / size
        left[:, :, j] -= np.tensordot(solution, states[:, :, :, j], axes=1)
    return left


def visibilities(
    machine: Machine, trials: Sequence[Trial], runs: Sequence[Run], columns: Sequence[Array]
) -> list[float]:
    """RMS of what stays over all experiments, beyond the floor and in its units; the most visible of the outputs."""
    found = []
    for trial, left, own in zip(trials, residuals(machine, trials, runs), columns, strict=True):
        floor = np.array(trial.floor)
        if not (np.isfinite(left).all() and np.isfinite(own).all()):
            found.append(MOST)
            continue
        ratio = scatter(unexplained(left, own, len(machine.free), 1.0 / floor)) / floor
        found.append(min(float(np.sqrt(np.maximum(ratio**2 - 1.0, 0.0).max())), MOST))
    return found


def visibilities_beside(
    machine: Machine, trials: Sequence[Trial], runs: Sequence[Run], columns: Sequence[Array], *, fine: bool = True
) -> list[tuple[float, ...]]:
    """By effect of each trial, the RMS of what it adds beside the trial's others, likewise; that of a single effect is all that there is.

    The run with all effects less the run without this one, projected off as :func:`unexplained` does.
    """
    every = [(i, k) for i, trial in enumerate(trials) for k in range(len(trial.plan))]
    without = [_without(trials[i], k) for i, k in every]
    whole = residuals(machine, trials, runs)
    others = residuals(machine, without, machine.run(without, fine=fine))
    found: list[list[float]] = [[] for _ in trials]
    for (i, _), other in zip(every, others, strict=True):
        floor, added = np.array(trials[i].floor), whole[i] - other
        if np.isfinite(added).all() and np.isfinite(columns[i]).all():
            ratio = scatter(unexplained(added, columns[i], len(machine.free), 1.0 / floor)) / floor
            found[i].append(min(float(ratio.max()), MOST))
        else:
            found[i].append(MOST)
    return [tuple(one) for one in found]


def _without(trial: Trial, number: int) -> Trial:
    """The trial without one of its effects, the others as they are."""

    def rest(values: Sequence[Any]) -> list[Any]:
        return [value for k, value in enumerate(values) if k != number]

    return replace(trial, plan=tuple(rest(trial.plan)), scales=rest(trial.scales), switches=rest(trial.switches))


def _together(machine: Machine, runs: Sequence[Run]) -> tuple[Array, Array, Array]:
    """Recorded commands (samples, lanes), start states, and outputs (outputs, samples, lanes) of all runs."""
    b = machine.before
    command = np.concatenate([run.command[b:] for run in runs], axis=-1)
    start = np.concatenate([run.start for run in runs], axis=1)
    return command, start, np.concatenate([run.outputs[:, b:] for run in runs], axis=2)


def scatter(values: Array) -> Array:
    """RMS by output."""
    return np.sqrt(np.mean(values**2, axis=(1, 2)))
