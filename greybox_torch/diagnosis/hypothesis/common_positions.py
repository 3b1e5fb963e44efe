"""Experiments that are fitted together begin somewhere: an effect that follows a position is at one place of the machine in all of them.

Where no sensor shows that position, it begins at zero in every experiment unless something tells otherwise, and a ripple that has one phase
in the first experiment has another in the second: no phase fits both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from greybox_torch.diagnosis.hypothesis.start_positions import begun_at, placed
from greybox_torch.diagnosis.places import NOWHERE, Places
from greybox_torch.diagnosis.settings import SearchBudget
from greybox_torch.estimate.initial import beginning
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.window_fit import WindowFit, fit_windows
from greybox_torch.simulation.simulator import Simulator


def with_common_positions(
    problems: Sequence[Problem],
    early: Sequence[Problem],
    simulator: Simulator,
    length: int,
    known: Sequence[WindowFit],
    budget: SearchBudget,
    rough: bool,
    places: Places = NOWHERE,
) -> tuple[list[Problem], list[Problem]]:
    """``problems`` and ``early``, of one model, with every experiment beginning where its positions begin beside the others.

    As one of the fits ``known`` has it, or ``places`` do, else from a fit to the longest experiment alone, beside which the others are
    placed. Positions that a sensor shows, and a single experiment, need nothing of this.

    Args:
        length: of the windows, in samples.
        rough: whether places that are known are near enough.
    """
    names, count = _placed_names(problems[0]), len(problems[0].records.first)
    if not names:
        return list(problems), list(early)
    told = [[places.get(e, {}).get(name, np.nan) for name in names] for e in problems[0].records.names]
    fit = next((f for f in known if _has(f, names, count)), None)
    if fit is None and np.isfinite(told).all():
        return [_placed_at(p, told, names) for p in problems], [_placed_at(p, told, names) for p in early]
    if fit is None:
        fit = _beside_the_longest(problems[0], simulator, length, budget)
    elif not rough:
        fit = placed(_begun(problems[0], fit, names).fixed, simulator, length, budget) or fit
    if fit is None:
        return list(problems), list(early)
    return [_begun(p, fit, names) for p in problems], [_begun(p, fit, names) for p in early]


def begun_as(problem: Problem, shorter: WindowFit | None) -> WindowFit | None:
    """A fit that start states are taken from, its positions moved along with where ``problem`` has every experiment begin.

    Seen: the teeth of a winder's motor. The second of two experiments was placed rightly by every refit, and begun where the first one,
    before the law was known, had it.
    """
    names = _placed_names(problem)
    if shorter is None or not names or not _has(shorter, names, len(problem.initial)):
        return shorter
    there, to = _columns(shorter.problem, names), problem.initial[:, _columns(problem, names)]
    experiments = problem.records.experiments(shorter.windows.start)
    return replace(shorter, starts=begun_at(shorter.starts, there, to, experiments), along=None)


def placed_alike(one: Problem, other: Problem) -> bool:
    """Whether two problems of one model have every experiment begin at the same positions, where no sensor shows those."""
    names = _placed_names(one)
    if not names:
        return True
    return np.allclose(*(p.initial[:, _columns(p, names)] for p in (one, other)), rtol=0, atol=1e-3)


def _placed_names(problem: Problem) -> list[str]:
    """The states that are placed beside one another: none, of a single experiment."""
    trials = problem.model.start_trials(problem.values) if len(problem.records.first) > 1 else []
    return list(trials[0]) if trials else []


def _begun(problem: Problem, fit: WindowFit, names: Sequence[str]) -> Problem:
    """``problem`` with the states ``names`` beginning where they do in ``fit``."""
    return _placed_at(problem, fit.problem.initial[:, _columns(fit.problem, names)], names)


def _placed_at(problem: Problem, rows: ArrayLike, names: Sequence[str]) -> Problem:
    """``problem`` with the states ``names`` beginning at ``rows`` (E, k)."""
    initial = problem.initial.copy()
    initial[:, _columns(problem, names)] = rows
    return replace(problem, initial=initial)


def _has(fit: WindowFit, names: Sequence[str], count: int) -> bool:
    """Whether a fit knows where the states ``names`` begin in ``count`` experiments."""
    there = {s.name for s in fit.problem.model.states}
    return set(names) <= there and len(fit.problem.initial) == count


def _columns(problem: Problem, names: Sequence[str]) -> list[int]:
    states = [s.name for s in problem.model.states]
    return [states.index(name) for name in names]


def _beside_the_longest(problem: Problem, simulator: Simulator, length: int, budget: SearchBudget) -> WindowFit | None:
    """All experiments placed with the parameters of a fit to the longest alone."""
    longest = int(np.argmax(problem.records.lengths))
    alone = replace(beginning(problem, longest, 1.0), free=problem.free)
    fitted = fit_windows(alone, simulator, length, settings=budget.first_iterations)
    if fitted is None:
        return None
    begun = problem.with_values(fitted.problem.values).fixed
    return placed(begun, simulator, length, budget, nearer=False, kept=longest)
