"""Effects drawn to be just so visible, as far as the machine lets them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from experiments.concealed.machines.base import Machine, Run, Trial
from experiments.concealed.visibility import (
    free_run,
    residuals,
    scatter,
    sensitivities,
    unexplained,
    visibilities,
    visibilities_beside,
)

Array = NDArray[np.float64]

WORDS = {"weak": (2.5, 4.0), "moderate": (8.0, 20.0), "dominant": (40.0, 100.0), "overwhelming": (300.0, 3000.0)}
"""Visibilities that are aimed at, by word."""
ROUNDS = 4
"""Of the search for a scale."""
ROUNDS_BESIDE = 3
STRONGER = 3.0
"""Rounds in which effects of a pair are made stronger that the other hides, and times as strong at most in each."""
HALVINGS = 5
LEAST_SCALE = 1e-4


@dataclass
class _Search:
    """The scale of one effect of one trial. Visibility grows about as the scale does, but not where a pendulum goes over the top."""

    trial: int
    effect: int
    solo: Trial
    best: float = 1.0
    miss: float = np.inf
    below: float = 0.0
    above: float = np.inf

    def tell(self, seen: float) -> None:
        """Note how visible the effect is at the present scale, and choose the next."""
        scale, target = self.solo.scales[0], self.solo.targets[0]
        miss = abs(float(np.log(max(seen, 1e-3) / target)))
        if miss < self.miss:
            self.best, self.miss = scale, miss
        if seen < target:
            self.below = max(self.below, scale)
        else:
            self.above = min(self.above, scale)
        proposed = scale * float(np.clip(target / max(seen, 0.05), 0.02, 10.0))
        if not self.below < proposed < self.above and self.below < self.above < np.inf:
            proposed = float(np.sqrt(max(self.below, 0.1 * self.above) * self.above))
        self.solo.scales[0] = float(np.clip(proposed, LEAST_SCALE, self.solo.machine.largest_scale))


def calibrate(machine: Machine, trials: Sequence[Trial]) -> list[Run]:
    """Scale every trial's effects to the visibility aimed at; set scales, switches, floor and visibility; the final runs.

    Effects of a pair are scaled each on its own, and made stronger where the other hides them. A trial without targets keeps the scales
    that it has.
    """
    plain = machine.run(trials, effects=False)
    columns = sensitivities(machine, trials, plain)
    _set_floors(machine, trials, residuals(machine, trials, plain), columns)
    _set_scales(machine, trials, plain, columns)
    both = zip(trials, plain, columns, strict=True)
    _bring_out(machine, [one for one in both if one[0].targets and len(one[0].plan) > 1])
    runs = _finite_runs(machine, trials, plain)
    own = sensitivities(machine, trials, runs)
    for trial, value in zip(trials, visibilities(machine, trials, runs, own), strict=True):
        trial.visibility = value
    pairs = [i for i, trial in enumerate(trials) if len(trial.plan) > 1]
    chosen = ([some[i] for i in pairs] for some in (trials, runs, own))
    for i, values in zip(pairs, visibilities_beside(machine, *chosen) if pairs else [], strict=True):
        trials[i].beside = values
    return runs


def _set_floors(machine: Machine, trials: Sequence[Trial], left: Sequence[Array], columns: Sequence[Array]) -> None:
    """What a refit, and what the true model in free runs, leaves of noise and nuisances."""
    free = len(machine.free)
    for trial, residual, own in zip(trials, left, columns, strict=True):
        weights = 1.0 / scatter(residual)
        trial.floor = tuple(float(x) for x in scatter(unexplained(residual, own, free, weights)))
        trial.sigma = tuple(float(x) for x in scatter(free_run(residual, own[free:], weights)))


def _set_scales(machine: Machine, trials: Sequence[Trial], plain: Sequence[Run], columns: Sequence[Array]) -> None:
    """Search the scale of every effect that has a target, all of them side by side."""
    searches = [
        _Search(i, k, replace(trial, plan=(name,), scales=[trial.scales[k]], targets=(trial.targets[k],)))
        for i, trial in enumerate(trials)
        if trial.targets
        for k, name in enumerate(trial.plan)
    ]
    if not searches:
        return
    solos, own = [search.solo for search in searches], [columns[search.trial] for search in searches]
    for _ in range(ROUNDS):
        for search in searches:
            search.solo.draw_switches(plain[search.trial])
        for search, seen in zip(
            searches, visibilities(machine, solos, machine.run(solos, fine=False), own), strict=True
        ):
            search.tell(seen)
    for search in searches:
        trials[search.trial].scales[search.effect] = search.best


def _bring_out(machine: Machine, pairs: Sequence[tuple[Trial, Run, Array]]) -> None:
    """Effects that what is beside them hides made stronger, until each adds what was aimed at, as far as the machine lets them.

    Each alone may be plain to see, and yet take up what the other does: a stop that a delay's error hides, a constant force in a dead band.
    """
    for _ in range(ROUNDS_BESIDE if pairs else 0):
        trials = [trial for trial, *_ in pairs]
        runs = _finite_runs(machine, trials, [plain for _, plain, _ in pairs], fine=False)
        seen = visibilities_beside(machine, trials, runs, [own for *_, own in pairs], fine=False)
        for trial, values in zip(trials, seen, strict=True):
            wanted = (t / max(v, 1e-3) for t, v in zip(trial.targets, values, strict=True))
            larger = [scale * float(np.clip(w, 1.0, STRONGER)) for scale, w in zip(trial.scales, wanted, strict=True)]
            trial.scales = [max(s, min(b, machine.largest_scale)) for s, b in zip(trial.scales, larger, strict=True)]


def _finite_runs(machine: Machine, trials: Sequence[Trial], plain: Sequence[Run], *, fine: bool = True) -> list[Run]:
    """The runs with effects, those that overflow (a pair may, where each alone does not) at half the strength, until none does."""
    for _ in range(HALVINGS):
        for trial, run in zip(trials, plain, strict=True):
            trial.draw_switches(run)
        runs = machine.run(trials, fine=fine)
        lost = [trial for trial, run in zip(trials, runs, strict=True) if not np.isfinite(run.outputs).all()]
        if not lost:
            return runs
        for trial in lost:
            trial.scales = [0.5 * scale for scale in trial.scales]
    names = ", ".join(f"{'+'.join(trial.plan) or 'no effect'} (number {trial.number})" for trial in lost)
    raise FloatingPointError(
        f"the simulation of the {machine.name} with {names} overflowed; expected finite recordings"
    )
