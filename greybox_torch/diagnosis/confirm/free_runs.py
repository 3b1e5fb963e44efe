"""The free runs that the verdict reports, of the card's values, the refitted model and the model with effects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from greybox_torch.data import DataSet, Recording
from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.confirm.take_back import UNEXERCISED
from greybox_torch.diagnosis.hypothesis.final import Final
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.verdict import Trace
from greybox_torch.estimate.comparison import Comparison, compare
from greybox_torch.estimate.initial import estimate_initial
from greybox_torch.estimate.problem import Problem, all_starts_free, make_problem, problem_for
from greybox_torch.simulation.stepper import Stepper, make_stepper

CONFIRMED = 5.0
"""Standard errors of held-out gain from which a finding stands whatever the free runs of the validation experiments say."""


class Judgement:
    """The models on every experiment: the card's values, the plain refit, and the model with effects."""

    def __init__(
        self,
        dataset: DataSet,
        problem: Problem,
        state: SearchState,
        plain: Final,
        augmented: Final,
        substeps: int,
        device: str,
        gains: Mapping[str, Gain],
    ) -> None:
        self.gains = gains
        self.recordings = dataset.recordings
        self.problem = all_starts_free(dataset, make_problem(dataset, problem.model, dataset.recordings))
        self.plain, self.augmented, self.substeps, self.device = plain, augmented, substeps, device
        self.start = self._compared(problem, problem.values, None)
        self.refit = self._compared(plain.problem, plain.problem.values, plain)
        self.with_effects = (
            self._compared(augmented.problem, augmented.problem.values, augmented) if state.effects else self.refit
        )
        self.sums = tuple(self._energy(c) for c in (self.refit, self.with_effects))

    @property
    def holds(self) -> bool:
        """Whether the effects are borne out: over windows of the validation experiments, or by their free runs.

        A free run can go astray where the machine is nearly bistable, however right the model is; windows with free starts cannot.
        """
        confirmed = bool(self.gains) and all(g.errors_away > CONFIRMED for g in self.gains.values())
        return confirmed or self.sums[1] < (1 + UNEXERCISED) * self.sums[0]

    def comparisons(self, effects: bool) -> dict[str, Comparison]:
        return {"start": self.start, "refit": self.refit, "augmented": self.with_effects if effects else self.refit}

    def traces(self, effects: bool) -> tuple[Trace, ...]:
        last = self.with_effects if effects else self.refit
        result = []
        for e, recording in enumerate(self.recordings):
            for k, output in enumerate(self.problem.model.outputs):
                simulated = [c.simulated[e][:, k] for c in (self.start, self.refit, last)]
                measured, time_axis = (
                    self.problem.records.y[k, self.problem.records.span(e)],
                    self.problem.records.time(e),
                )
                result.append(
                    Trace(recording.name, recording.role, output.name, output.unit, time_axis, measured, *simulated)
                )
        return tuple(result)

    def _compared(self, like: Problem, values: np.ndarray, final: Final | None) -> Comparison:
        """Free runs of all experiments; start states fitted on whole estimation records where there are any, else on the first tenth."""
        named = dict(zip(like.names, map(float, values), strict=True))
        problem = (
            self.problem.with_values(values)
            if like.model is self.problem.model
            else problem_for(self.problem, like.model, named)
        )
        stepper = make_stepper(like.model, (), device=self.device)
        started = estimate_initial(problem, stepper, substeps=self.substeps)
        if final is not None:
            initial = started.initial.copy()
            for row, name in zip(final.problem.initial, final.problem.records.names, strict=True):
                initial[started.records.names.index(name)] = row
            started = replace(started, initial=initial)
        return _scored(started, self.recordings, stepper, self.substeps)

    def _energy(self, comparison: Comparison) -> float:
        roles = [s.role for s in comparison.scores]
        judged = [s for s in comparison.scores if s.role == "validation" or "validation" not in roles]
        return float(sum(s.rmse**2 for s in judged))


def _scored(problem: Problem, recordings: tuple[Recording, ...], stepper: Stepper, substeps: int) -> Comparison:
    return compare(problem, recordings, stepper, substeps=substeps, estimate_starts=False)
