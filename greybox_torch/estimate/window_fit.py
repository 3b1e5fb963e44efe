"""Multiple shooting with free window starts: the way to good parameters from poor ones.

The record is cut into windows that are simulated side by side, each from a start state of its own. The start states are eliminated
window by window (Schur complement), so that the step in the parameters costs no more than without them. Because no window is long, no
simulation has time to overflow; because the start states are free, errors do not pile up from window to window.

Source: H. G. Bock, "Recent advances in parameter identification techniques for ODE", 1983.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.estimate.carried_starts import carried_starts
from greybox_torch.estimate.compared import compared
from greybox_torch.estimate.levenberg_marquardt import ROUGH, Settings
from greybox_torch.estimate.open_starts import begun_with, open_starts
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.rival import Rival
from greybox_torch.estimate.rough_starts import rough_starts
from greybox_torch.estimate.window_step import Hold, WindowModel, held, stepped
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import Windows, cut

SHRINKING = 30.0
"""Samples' worth of error that a shrunk parameter costs when it is as large as it began."""

NEGLIGIBLE = 1e-2
"""Predicted gain, as a share of the tolerance, from which a step is not worth simulating."""

LEAST_GAIN_RATIO = 1e-4
"""Share of the predicted gain that a step must bring to be accepted."""

FIRST_DAMPING = 1e-2
"""Damping that a descent begins with, as a share of the curvature."""

LEAST_LEFT = 0.5
"""Share of what was measured that late outputs have to leave: the later they are, the less is compared; nothing is what anything fits."""

CARRY_EVERY = 4
"""Accepted steps after which carried states are brought along anew, with the parameters as they then are."""


@dataclass(frozen=True)
class WindowFit:
    """Result: the problem with its parameters improved, window starts (W, n_x), mean squared weighted error, energy of the error per
    window (W,), evaluations used; ``along``, the starts with carried states brought along (W, n_x), where that is known; ``damping``,
    with which the descent would go on; ``ended``, the pass at its starts, without holds, and what it was simulated with.
    """

    problem: Problem
    windows: Windows
    starts: np.ndarray
    mean_square: float
    energies: np.ndarray
    evaluations: int
    along: np.ndarray | None = None
    damping: float = FIRST_DAMPING
    ended: tuple[Simulator, WindowModel] | None = None

    def known(self, simulator: Simulator, starts: np.ndarray) -> WindowModel | None:
        """The pass at ``starts`` where they are its own, which need not be simulated again; None elsewhere."""
        if self.ended is None or self.ended[0] is not simulator or starts is not self.starts:
            return None
        return self.ended[1]


def fit_windows(
    problem: Problem,
    simulator: Simulator,
    length: int,
    *,
    starts: np.ndarray | None = None,
    shorter: WindowFit | None = None,
    settings: Settings = ROUGH,
    size: float | None = None,
    rival: Rival | None = None,
    damping: float = FIRST_DAMPING,
    carried: bool = False,
    known: WindowModel | None = None,
) -> WindowFit | None:
    """Estimate the free parameters on windows of ``length`` samples with free start states; None where even these overflow.

    Args:
        starts: window start states (W, n_x) to begin with; by default those of ``shorter`` at the same samples, else the measured
            values where a state is measured and the model's start value where not.
        shorter: a fit on shorter windows, of this model or of the model that it extends.
        size: the size at which a shrunk parameter costs :data:`SHRINKING` samples' worth of error; the largest start value by default.
        rival: a fit of the same windows from another start, beside which this one is given up early where it is far behind.
        damping: to begin with; that of a fit which is carried on.
        carried: whether ``starts`` are what :func:`carried_starts` brings along with the values of ``problem``.
        known: the pass at these ``starts`` and values, where it was simulated before.
    """
    windows = cut(problem.records, length)
    states = starts
    if states is None and shorter is not None:
        states = _starts_of(shorter, problem, simulator, windows)
    elif states is None:
        states = carried_starts(problem, simulator, windows, rough_starts(problem, windows))
    found = known or evaluate(problem, simulator, windows, states)
    if found is None:
        return None
    hold = _weak_hold(problem, states, found.mean_square, windows.steps, size)
    expected = np.abs(problem.expected[problem.free])
    sizes = expected if size is None else np.where(expected > 0, expected, 1.0)  # weights of a network: of order one
    here = held(found, hold)
    evaluations, accepted_steps, growth, change = int(known is None), 0, 2.0, 1.0
    along = states if carried else None  # carried with the values and starts as they now are
    for iteration in range(settings.iterations):
        if rival is not None and rival.lost(here.mean_square, change, iteration, settings.iterations - iteration):
            break
        accepted = False
        for _ in range(settings.trials):
            trial, trial_states, predicted = stepped(problem, here, states, damping, sizes)
            if predicted <= NEGLIGIBLE * settings.tolerance * here.cost:
                break
            there, passed, most = None, None, here.cost - LEAST_GAIN_RATIO * predicted
            # After one rejected step the next is as likely to be another: its cost alone takes a third of a pass with tangents.
            rejected_before = growth > 2.0
            if problem.admissible(trial.values):
                evaluations += 1
                if not (rejected_before and _exceeds(most, trial, simulator, windows, trial_states, hold)):
                    passed = evaluate(trial, simulator, windows, trial_states)
                    there = None if passed is None else held(passed, hold)
            gain = -1.0 if there is None else (here.cost - there.cost) / predicted
            if passed is not None and there is not None and gain > LEAST_GAIN_RATIO:
                change = (here.cost - there.cost) / here.cost
                problem, states, found, here, accepted, along = trial, trial_states, passed, there, True, None
                damping, growth = max(damping * max(1 / 3, 1.0 - (2.0 * min(gain, 1.0) - 1.0) ** 3), 1e-9), 2.0
                accepted_steps += 1
                break
            damping, growth = damping * growth, growth * 2.0
        still = not accepted or change < settings.tolerance
        if along is None and problem.carried.any() and (still or accepted_steps % CARRY_EVERY == 0):
            along = carried_starts(problem, simulator, windows, states)
            passed = evaluate(problem, simulator, windows, along)
            evaluations += 1
            if passed is not None and (again := held(passed, hold)).cost < here.cost:
                still = still and again.cost > (1 - settings.tolerance) * here.cost
                states, found, here, damping = along, passed, again, min(damping, FIRST_DAMPING)
        if still:
            break
    problem = begun_with(problem, windows, states)
    ended = (simulator, found)
    return WindowFit(problem, windows, states, here.mean_square, here.energies, evaluations, along, damping, ended)


def _starts_of(shorter: WindowFit, problem: Problem, simulator: Simulator, windows: Windows) -> np.ndarray:
    """Start states from a fit on shorter windows, where one of those begins; rough ones elsewhere.

    States that it does not have and that are carried are brought along its windows: their trajectories stay near the measured one, so that
    a position does not drift.
    """
    model, before, begin = problem.model, shorter.problem.model, shorter.windows.start
    known, between = [s.name for s in before.states], rough_starts(problem, shorter.windows)
    for i, state in enumerate(model.states):
        if state.name in known:
            between[:, i] = shorter.starts[:, known.index(state.name)]
    between = model.taken_over(between, before, problem.driving_records, begin, problem.values)
    between = carried_starts(problem, simulator, shorter.windows, between)
    states = rough_starts(problem, windows)
    index = np.minimum(np.searchsorted(begin, windows.start), len(begin) - 1)
    return np.where((begin[index] == windows.start)[:, None], between[index], states)


def states_along(fit: WindowFit, simulator: Simulator) -> np.ndarray:
    """States (N, n_x) at the samples of the records, every window from its own start."""
    problem, windows = fit.problem, fit.windows
    run = simulator.run(problem.driving_records, Pass(windows, problem.values, fit.starts, keep_states=True))
    assert run.states is not None
    states = np.zeros((problem.records.u.shape[1], run.states.shape[2]))
    for w, (first, last) in enumerate(zip(windows.start, windows.last, strict=True)):
        states[first : last + 1] = run.states[w, : last - first + 1]
    return states


def _weak_hold(problem: Problem, states: np.ndarray, mean_square: float, steps: int, size: float | None) -> Hold:
    """Holds that matter only where the data say nothing: start states within several times their spread, parameters within several
    times what is expected of them (without which a friction law's shape can wander off where no speed is visited; held where each fit
    of many begins, it would still get there by and by).
    """
    measured = (problem.records.y * problem.weights[:, None])[~np.isnan(problem.records.y).all(axis=1)]
    mean_square = min(mean_square, float(np.nanvar(measured, axis=1).mean()))  # what explodes must not freeze all
    spread = np.nanstd(states, axis=0)
    least = max(float(np.nanstd(problem.records.y)), 1e-6)
    spread = np.where(spread > 1e-9 * np.abs(states).max(axis=0), spread, least)
    values = problem.expected[problem.free]
    # What is expected to be next to nothing, as where an output never moves, is of no size by which it could be held.
    sized = values**2 > np.finfo(float).tiny
    value_weights = np.where(sized, 10.0 * mean_square / np.where(sized, values, 1.0) ** 2, 0.0)
    declared = {p.name: p.shrunk for p in problem.model.declared_parameters}
    shrunk = np.array([declared[n] for n in problem.free_names], dtype=bool)
    if shrunk.any():
        size = max(float(np.abs(problem.values[problem.free][shrunk]).max()) if size is None else size, 1e-12)
        value_weights = np.where(shrunk, SHRINKING * mean_square / size**2, value_weights)
        values = np.where(shrunk, 0.0, values)
    return Hold(states, 1e-4 * mean_square * steps / spread**2, values, value_weights)


def evaluate(
    problem: Problem,
    simulator: Simulator,
    windows: Windows,
    states: np.ndarray,
) -> WindowModel | None:
    """One pass over windows from start ``states`` (W, n_x); None where it overflows, or late outputs leave hardly anything to compare."""
    n_p, records, begun = int(problem.free.sum()), problem.window_records, open_starts(problem, windows)
    tangents = {"tangents": n_p > 0, "start_directions": begun.directions}
    asked = Pass(windows, problem.values, states, **tangents, weights=problem.weights)
    samples = compared(records, windows)
    if samples < LEAST_LEFT * compared(problem.records, windows):
        return None
    run = simulator.run(records, asked)
    assert run.normal is not None
    if not np.isfinite(run.normal).all():
        return None
    h, g = run.normal[:, :-1, :-1], -run.normal[:, :-1, -1]
    energies = run.normal[:, -1, -1]
    return WindowModel(
        cost=0.5 * float(energies.sum()),
        hpp=h[:, :n_p, :n_p].sum(0),
        gp=g[:, :n_p].sum(0),
        hss=begun.without_bound(h[:, n_p:, n_p:]),
        hsp=h[:, n_p:, :n_p],
        gs=g[:, n_p:],
        mean_square=float(energies.sum()) / max(samples, 1),
        energies=energies,
        open_states=begun.states,
        away=states[:, begun.states],
        bound=begun.bound,
        moved=problem.values[problem.free],
    )


def _exceeds(
    most: float, problem: Problem, simulator: Simulator, windows: Windows, states: np.ndarray, hold: Hold
) -> bool:
    """Whether the cost of :func:`evaluate` exceeds ``most`` or overflows, by a pass without tangents."""
    run = simulator.run(problem.window_records, Pass(windows, problem.values, states, weights=problem.weights))
    assert run.normal is not None
    begun = open_starts(problem, windows)
    cost = 0.5 * float(run.normal[:, -1, -1].sum())
    cost += hold.cost(states[:, begun.states], begun.states, begun.bound, problem.values[problem.free])
    return not cost < most
