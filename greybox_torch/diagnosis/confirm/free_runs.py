"""Free runs of whole experiments: all of the card, whatever their role, each from start states that suit it."""

from __future__ import annotations

import time
from collections.abc import Collection
from dataclasses import replace

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.diagnosis.confirm.along_travel import begun_along_travel
from greybox_torch.diagnosis.confirm.unstable import lost, parted
from greybox_torch.diagnosis.hypothesis.final import Final
from greybox_torch.diagnosis.places import NOWHERE, Places
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.comparison import Comparison, compare
from greybox_torch.estimate.initial import estimate_initial
from greybox_torch.estimate.problem import Problem, all_starts_free, make_problem, problem_for
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.substeps import LARGEST

FINER = 4
"""How many times finer steps become at a time where free runs are lost with coarser ones."""


class FreeRuns:
    """The experiments of a data set, and the model at the card's values on them (``start``).

    ``problem`` is the model as it stands on all of them; ``seconds`` is how long the first comparison took, by which one can tell how long
    the next ones will take.
    """

    def __init__(self, study: Study, dataset: DataSet) -> None:
        began, card = time.perf_counter(), study.problem
        self.settings, self.options, self.recordings = study.settings, study.options, dataset.recordings
        self.problem = all_starts_free(dataset, make_problem(dataset, card.model, dataset.recordings))
        self.start = self._compared(card, card.values, None)
        self.seconds = time.perf_counter() - began

    def of(self, final: Final, places: Places = NOWHERE) -> Comparison:
        """A model fitted to whole estimation records.

        Args:
            places: start positions that no sensor shows, by experiment and state, as windows of the whole experiments have them; taken
                where the first tenth of an experiment says nothing else, and its free run goes no nearer from elsewhere.
        """
        return self._compared(final.problem, final.problem.values, final, places)

    def parted(self, final: Final, comparison: Comparison, asked: Collection[str]) -> dict[str, float]:
        """By name of ``asked``, how far free runs part that begin next to those of ``comparison``, see :func:`parted`."""
        return parted(*self._begun_as(final, comparison), asked, self.settings)

    def lost(self, final: Final, comparison: Comparison, asked: Collection[str]) -> dict[str, bool]:
        """Of ``asked``, the experiments whose free runs are lost, and whether they fall away from an equilibrium, see :func:`lost`."""
        return lost(*self._begun_as(final, comparison), asked, self.settings)

    def _begun_as(self, final: Final, comparison: Comparison) -> tuple[Problem, Simulator]:
        """All experiments with a model and the start states of its free runs, and its simulator."""
        problem, simulator = self._simulated_as(final.problem, final.problem.values)
        return problem.with_values(problem.values, np.array(comparison.initial)), simulator

    def _compared(self, like: Problem, values: np.ndarray, final: Final | None, places: Places = NOWHERE) -> Comparison:
        """Free runs of all experiments; start states fitted on whole estimation records where there are any, else on the first tenth."""
        problem, simulator = self._simulated_as(like, values)
        started = estimate_initial(problem, simulator, places=places)
        if final is not None:
            initial = started.initial.copy()
            for row, name in zip(final.problem.initial, final.problem.records.names, strict=True):
                if name in started.records.names:  # else a stretch from within a recording
                    initial[started.records.names.index(name)] = row
            started = replace(started, initial=initial)
            fitted = final.problem.records.names
            asked = [e for e, name in enumerate(started.records.names) if name not in fitted]
            started = begun_along_travel(started, simulator, asked)
        return self._simulated(started, simulator)

    def _simulated(self, started: Problem, simulator: Simulator) -> Comparison:
        """The free runs, with finer steps where they are lost without: a refit that lacks something may be far stiffer than the card.

        Seen: a heating coil's air side, whose heat capacity went to a tenth. Where the finest steps are lost as well, so is the machine.
        """
        found = coarse = compare(started, self.recordings, simulator, estimate_starts=False)
        while not _finite(found) and simulator.substeps < LARGEST:
            simulator = simulator.with_substeps(FINER * simulator.substeps)
            found = compare(started, self.recordings, simulator, estimate_starts=False)
        return found if _finite(found) else coarse

    def _simulated_as(self, like: Problem, values: np.ndarray) -> tuple[Problem, Simulator]:
        """All experiments with the model and the parameter values of another problem, and its simulator."""
        named = dict(zip(like.names, map(float, values), strict=True))
        problem = (
            self.problem.with_values(values)
            if like.model is self.problem.model
            else problem_for(self.problem, like.model, named)
        )
        return problem, Simulator.of(like.model, (), self.options)


def _finite(comparison: Comparison) -> bool:
    return all(np.isfinite(outputs).all() for outputs in comparison.simulated)
