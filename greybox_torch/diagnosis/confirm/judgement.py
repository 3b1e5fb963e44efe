"""What the free runs say of a model: whether its effects hold on the validation experiments, and what it leaves there."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from greybox_torch.data import Recording
from greybox_torch.diagnosis.confirm.free_runs import FreeRuns
from greybox_torch.diagnosis.confirm.unstable import followed
from greybox_torch.diagnosis.contradictions import worse_than_refit
from greybox_torch.diagnosis.hypothesis.final import Final
from greybox_torch.diagnosis.hypothesis.noise import output_floors
from greybox_torch.diagnosis.places import NOWHERE, Places
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.estimate.comparison import Comparison, fit_rows, mean_fit
from greybox_torch.estimate.problem import Problem


@dataclass(frozen=True, eq=False)
class Judgement:
    """The models on every experiment: the card's values, the plain refit, and the model with effects (the refit where there are none).

    ``refused_in``: the validation experiment of which free runs came out worst with the effects that were taken back for it; "" for none.
    """

    free_runs: FreeRuns
    plain: Final
    augmented: Final
    refit: Comparison
    with_effects: Comparison
    refused_in: str = ""

    @staticmethod
    def of(free_runs: FreeRuns, plain: Final) -> Judgement:
        """Of the model as it stands."""
        return Judgement(free_runs, plain, plain, refit := free_runs.of(plain), refit)

    def having(self, augmented: Final, places: Places = NOWHERE) -> Judgement:
        """Beside the same plain refit, another model with effects; ``places`` as for :meth:`FreeRuns.of`."""
        return replace(self, augmented=augmented, with_effects=self.free_runs.of(augmented, places))

    def without_effects(self) -> Judgement:
        """With the plain refit in the place of the model with effects."""
        worst = max(self._worse, key=self._times_the_refit, default="")
        return replace(self, augmented=self.plain, with_effects=self.refit, refused_in=worst or self.refused_in)

    @property
    def start(self) -> Comparison:
        """The model at the card's values."""
        return self.free_runs.start

    @property
    def sums(self) -> tuple[float, float]:
        """Mean squared errors, summed over the validation experiments that count, in units of spread: the refit's, with effects."""
        return self._energy(self.refit, self.unstable), self._energy(self.with_effects, self.unstable)

    @property
    def missed(self) -> float:
        """Mean squared error beyond the noise of the model with effects, in the variances of its outputs, over the validation experiments
        that count; none where none does.
        """
        among = self.judges - self.unstable
        return self.mismatch(True, among) / max(1, len(among) * len(self.problem.model.outputs))

    @property
    def problem(self) -> Problem:
        """The plain model on all experiments, which are in the order of the card."""
        return self.free_runs.problem

    @property
    def recordings(self) -> tuple[Recording, ...]:
        """All experiments."""
        return self.free_runs.recordings

    @property
    def settings(self) -> DiagnosisSettings:
        """What is decided by."""
        return self.free_runs.settings

    @property
    def holds(self) -> bool:
        """Whether the model with effects simulates the validation experiments that count no worse than the one without."""
        return self._no_worse(self.unstable)

    def better_than(self, other: Judgement) -> bool:
        """Whether its model holds and ``other``'s does not, or on fewer experiments, or leaves more of those that count with both."""
        if not (self.holds and other.holds):
            return self.holds
        if len(self.unstable) != len(other.unstable):
            return len(self.unstable) < len(other.unstable)
        but = self.unstable | other.unstable
        return self._energy(self.with_effects, but) < self._energy(other.with_effects, but)

    @cached_property
    def unstable(self) -> frozenset[str]:
        """Validation experiments that do not count, as no free run of the model with effects follows them, and it comes out worse there.

        Not one that both models follow; none where they were more than half of all (what is left would say too little), but the ``lost``.
        """
        both = followed(self.refit, self.settings) & followed(self.with_effects, self.settings)
        parted = self.free_runs.parted(self.augmented, self.with_effects, self._worse - both)
        found = frozenset(name for name, share in parted.items() if share >= self.settings.least_parted)
        return self.lost | (found if 2 * len(found) <= len(self.judges) else frozenset())

    @cached_property
    def lost(self) -> frozenset[str]:
        """Validation experiments that the model with effects simulates worse, whose free runs are lost with the effects and without.

        With the effects they fall away from an equilibrium, where no start state is known well enough. A model without them may be damped
        by what its parameters became, and be lost more slowly.
        """
        with_effects = self.free_runs.lost(self.augmented, self.with_effects, self._worse) if self._worse else {}
        falling = {name for name, falls in with_effects.items() if falls}
        return frozenset(self.free_runs.lost(self.plain, self.refit, falling) if falling else ())

    @property
    def by_windows_alone(self) -> bool:
        """Whether the free runs of every validation experiment are ``lost``, so that windows alone can judge."""
        return self.judges <= self.lost

    @cached_property
    def _worse(self) -> frozenset[str]:
        return frozenset(n for n in self.judges if worse_than_refit(self._rows, self.judges - {n}))

    def _times_the_refit(self, experiment: str) -> float:
        """How many times the refit's squared error in an experiment is left with effects."""
        but = frozenset(self.judges - {experiment})
        before, after = (self._energy(c, but) for c in (self.refit, self.with_effects))
        return after / max(before, 1e-300)

    def _no_worse(self, but: frozenset[str]) -> bool:
        """Whether the model with effects simulates the validation experiments no worse, ``but`` for some.

        By the mean squared error, outputs in units of their spread, by the mean fit in %, what a user sees, and by the errors in units of
        those without effects, by which no verdict may contradict itself.
        """
        if worse_than_refit(self._rows, but) or self.judges <= but:
            return self.judges <= but
        before, after = (mean_fit(self.judging(c, but).scores) for c in (self.refit, self.with_effects))
        refit, with_effects = (self._energy(c, but) for c in (self.refit, self.with_effects))
        least = self.settings.unexercised
        return with_effects <= (1 + least) * refit and after >= before - 100 * least

    @property
    def _rows(self) -> list[dict[str, Any]]:
        return fit_rows({m: c.scores for m, c in self.comparisons(True).items()})

    @property
    def times_noise(self) -> np.ndarray:
        """How many times the sensors' noise the free runs' errors of the refitted model are, root mean square, by experiment (E,)."""
        return self._times_noise(self.refit)

    @property
    def mismatch_share(self) -> float:
        """Root mean square error of the refitted model's free runs beyond the noise, in units of the spread: of the worst experiment."""
        return float(np.sqrt(np.max(np.mean(self._beyond(self.refit, self._floors()), axis=1))))

    def left(self, effects: bool) -> tuple[float, float, str]:
        """What the recommended model leaves of the validation experiments: the share of the refitted model's mean squared error beyond the
        noise, the largest root mean square error in units of the noise, and in which experiment; NaN where no output shows the noise.
        """
        final = self.with_effects if effects else self.refit
        but = self.unstable if effects else frozenset[str]()
        times = np.where(self._judging(but), self._times_noise(final), np.nan)
        share = _share_left(*(self.mismatch(e, self.judges - but) for e in (False, effects)))
        if not np.isfinite(times).any():
            return share, np.nan, ""
        worst = int(np.nanargmax(times))
        return share, float(times[worst]), self.recordings[worst].name

    @property
    def begun(self) -> np.ndarray:
        """Where all experiments (E, n_x) begin, as the free runs of the model with effects have it."""
        return np.array(self.with_effects.initial)

    @property
    def judges(self) -> set[str]:
        """The names of the experiments that judge."""
        return {r.name for r, judging in zip(self.recordings, self._judging(), strict=True) if judging}

    def mismatch(self, effects: bool, among: Collection[str] | None = None) -> float:
        """Sum of the mean squared errors beyond the noise of the recommended model, outputs in units of their spread.

        Args:
            among: of these experiments; by default of all that judge.
        """
        final = self.with_effects if effects else self.refit
        chosen = np.array([r.name in (self.judges if among is None else among) for r in self.recordings])
        return float(self._beyond(final, self._floors())[chosen].sum())

    def comparisons(self, effects: bool) -> dict[str, Comparison]:
        """The models by the names that a verdict gives them; without ``effects`` the recommended one is the plain refit."""
        return {"start": self.start, "refit": self.refit, "augmented": self.with_effects if effects else self.refit}

    def _times_noise(self, comparison: Comparison) -> np.ndarray:
        """Root mean square errors in units of the noise, by experiment (E,), over the outputs whose noise is known; NaN where none is."""
        errors, floors = self._errors(comparison), output_floors(self.problem, self.settings)
        known = np.isfinite(floors) & (floors > 0)
        ratios = np.where(known, errors**2 / np.where(known, np.maximum(floors, 1e-300), 1.0), 0.0)
        count = known.sum(axis=1)
        return np.sqrt(np.where(count > 0, ratios.sum(axis=1) / np.maximum(count, 1), np.nan))

    def judging(self, comparison: Comparison, but: frozenset[str] = frozenset()) -> Comparison:
        """The experiments that judge alone, ``but`` for some."""
        names = self.judges - but
        return replace(comparison, scores=tuple(s for s in comparison.scores if s.experiment in names))

    def _judging(self, but: frozenset[str] = frozenset()) -> np.ndarray:
        """Which experiments (E,) judge: those of validation, all where there is none, ``but`` for some."""
        validation = np.array([r.role == "validation" for r in self.recordings])
        return (validation | ~validation.any()) & ~np.isin([r.name for r in self.recordings], list(but))

    def _energy(self, comparison: Comparison, but: frozenset[str]) -> float:
        """Sum of the mean squared errors of the experiments that judge, ``but`` for some, outputs in units of their spread."""
        return float(sum(self._beyond(comparison, 0.0)[self._judging(but)].ravel()))

    @np.errstate(over="ignore")
    def _beyond(self, comparison: Comparison, floors: np.ndarray | float) -> np.ndarray:
        """Mean squared errors (E, n_y) beyond ``floors``, outputs in units of their spread."""
        unit = self._units()
        spread = np.array([unit[o.name] for o in self.problem.model.outputs])
        return np.maximum(self._errors(comparison) ** 2 - floors, 0.0) / np.maximum(spread**2, 1e-300)

    def _errors(self, comparison: Comparison) -> np.ndarray:
        """Root mean square errors (E, n_y)."""
        return np.array([s.rmse for s in comparison.scores]).reshape(len(self.recordings), -1)

    def _floors(self) -> np.ndarray:
        """Mean squares of the noise (E, n_y), zero where it is not known."""
        return np.nan_to_num(output_floors(self.problem, self.settings))

    def _units(self) -> dict[str, float]:
        """The spread of every output; of one that never moves, the largest error of the re-estimated model."""
        units = {}
        for output, row in zip(self.problem.model.outputs, self.problem.records.y, strict=True):
            errors = [s.rmse for s in self.refit.scores if s.output == output.name and np.isfinite(s.rmse)]
            units[output.name] = float(np.nanstd(row)) or max(errors, default=0.0)
        return units


def _share_left(before: float, after: float) -> float:
    """What is left of an error: nothing where there was none beyond noise, all where free runs still overflow."""
    if not np.isfinite(before):
        return 0.0 if np.isfinite(after) else 1.0
    return after / before if before > 0 else 0.0
