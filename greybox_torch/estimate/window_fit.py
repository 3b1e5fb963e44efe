"""Multiple shooting with free window starts: the way to good parameters from poor ones.

The record is cut into windows that are simulated side by side, each from a start state of its own. The start states are eliminated
window by window (Schur complement), so that the step in the parameters costs no more than without them. Because no window is long, no
simulation has time to overflow; because the start states are free, errors do not pile up from window to window.

Source: H. G. Bock, "Recent advances in parameter identification techniques for ODE", 1983.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.estimate.levenberg_marquardt import ROUGH, Settings
from greybox_torch.estimate.problem import Problem, measured_at
from greybox_torch.simulate.stepper import Stepper, Windows, cut


@dataclass(frozen=True)
class WindowFit:
    """Result: the problem with its parameters improved, window starts (W, n_x), mean squared weighted error, evaluations used."""

    problem: Problem
    windows: Windows
    starts: np.ndarray
    mean_square: float
    evaluations: int


@dataclass(frozen=True)
class _Pass:
    cost: float
    hpp: np.ndarray
    gp: np.ndarray
    hss: np.ndarray
    hsp: np.ndarray
    gs: np.ndarray
    mean_square: float


def fit_windows(
    problem: Problem,
    stepper: Stepper,
    length: int,
    *,
    starts: np.ndarray | None = None,
    substeps: int = 1,
    settings: Settings = ROUGH,
) -> WindowFit | None:
    """Estimate the free parameters on windows of ``length`` samples with free start states; None where even these overflow.

    Args:
        starts: window start states (W, n_x) to begin with; by default the measured values where a state is measured, else the
            model's start value.
    """
    windows = cut(problem.tape, length)
    states = rough_starts(problem, windows) if starts is None else starts
    nothing_held = np.zeros(states.shape[1])
    first = _evaluate(problem, stepper, windows, states, states, nothing_held, substeps)
    if first is None:
        return None
    hold = 1e-4 * first.mean_square * windows.steps / _spread(problem, states) ** 2
    here = first
    reference, evaluations, damping, growth = states, 1, 1e-2, 2.0
    for _ in range(settings.iterations):
        accepted = False
        for _ in range(settings.trials):
            trial, trial_states = _stepped(problem, here, states, damping)
            there = None
            if problem.admissible(trial.values):
                there = _evaluate(trial, stepper, windows, trial_states, reference, hold, substeps)
                evaluations += 1
            if there is not None and there.cost < here.cost:
                change = (here.cost - there.cost) / here.cost
                problem, states, here, accepted = trial, trial_states, there, True
                damping, growth = max(damping / 5.0, 1e-9), 2.0
                break
            damping, growth = damping * growth, growth * 2.0
        if not accepted or change < settings.tolerance:
            break
    return WindowFit(problem, windows, states, here.mean_square, evaluations)


def rough_starts(problem: Problem, windows: Windows) -> np.ndarray:
    """Start states (W, n_x) from the measurement where a state is measured, else the value at the experiment's start."""
    experiment = np.searchsorted(problem.tape.first, windows.start, side="right") - 1
    states = problem.initial[experiment].copy()
    outputs = {o.name for o in problem.model.outputs}
    for i, state in enumerate(problem.model.states):
        if state.initial == "measured" or state.name in outputs:
            states[:, i] = measured_at(problem.model, state, problem.tape, windows.start)
    return states


def _spread(problem: Problem, states: np.ndarray) -> np.ndarray:
    """How far a start state may be from its first guess before it is held back: generous, so that the hold is weak."""
    outputs = np.nanstd(problem.tape.y)
    spread = np.nanstd(states, axis=0)
    return np.where(spread > 1e-9, spread, max(float(outputs), 1e-6))


def _evaluate(
    problem: Problem,
    stepper: Stepper,
    windows: Windows,
    states: np.ndarray,
    reference: np.ndarray,
    hold: np.ndarray,
    substeps: int,
) -> _Pass | None:
    count, n_x = states.shape
    n_p = int(problem.free.sum())
    eye = np.broadcast_to(np.eye(n_x), (count, n_x, n_x))
    run = stepper.run(
        problem.driving_tape, windows, problem.values, states, tangents=True, start_directions=eye, substeps=substeps, weights=problem.weights
    )
    assert run.normal is not None
    if not np.isfinite(run.normal).all():
        return None
    h, g = run.normal[:, :-1, :-1], -run.normal[:, :-1, -1]
    energy = float(run.normal[:, -1, -1].sum())
    away = states - reference
    return _Pass(
        cost=0.5 * (energy + float((hold * away**2).sum())),
        hpp=h[:, :n_p, :n_p].sum(0),
        gp=g[:, :n_p].sum(0),
        hss=h[:, n_p:, n_p:] + np.diag(hold),
        hsp=h[:, n_p:, :n_p],
        gs=g[:, n_p:] + hold * away,
        mean_square=energy / max(_weighted_samples(problem, windows), 1),
    )


def _weighted_samples(problem: Problem, windows: Windows) -> int:
    """How many samples the windows compare, missing ones not counted."""
    known = np.concatenate([[0], np.cumsum((~np.isnan(problem.tape.y)).sum(axis=0))])
    ends = np.minimum(windows.start + windows.steps, windows.last + 1)
    return int((known[ends] - known[windows.start]).sum())


def _stepped(problem: Problem, here: _Pass, states: np.ndarray, damping: float) -> tuple[Problem, np.ndarray]:
    """The damped Gauss-Newton step, window starts eliminated."""
    diagonal = np.einsum("wii->wi", here.hss)
    floor = 1e-12 * diagonal.max()
    damped = here.hss + np.eye(diagonal.shape[1]) * (damping * (diagonal + floor))[:, :, None]
    solved = np.linalg.solve(damped, np.concatenate([here.hsp, here.gs[..., None]], axis=2))
    back, own = solved[..., :-1], solved[..., -1]
    matrix = here.hpp - np.einsum("wsp,wsq->pq", here.hsp, back)
    right = -(here.gp - np.einsum("wsp,ws->p", here.hsp, own))
    scale = 1.0 / np.sqrt(np.maximum(np.diag(here.hpp), 1e-14 * max(np.diag(here.hpp).max(initial=0.0), 1e-300)))
    scaled = matrix * scale[:, None] * scale[None, :] + damping * np.eye(len(scale))
    step = scale * np.linalg.lstsq(scaled, right * scale, rcond=1e-14)[0] if len(scale) else np.zeros(0)
    values = problem.values.copy()
    low, high = problem.lower[problem.free], problem.upper[problem.free]
    values[problem.free] = np.clip(values[problem.free] + step, low, high)
    taken = values[problem.free] - problem.values[problem.free]
    return problem.with_values(values), states - own - back @ taken
