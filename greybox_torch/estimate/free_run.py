"""The free run of whole experiments: simulation, cost, and Gauss-Newton matrices."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from greybox_torch.estimate.levenberg_marquardt import Extra, Optimum, Quadratic, Settings, minimise
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.rough_starts import rough_starts
from greybox_torch.simulation.parallel_run import ParallelRun
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import whole_records

MOST_SENSITIVITIES = 20_000_000
"""Numbers that may be held at once for a closer look at what the data determine."""


def simulate(problem: Problem, simulator: Simulator) -> list[np.ndarray]:
    """Simulated outputs (N_e, n_y) of every experiment from its start state."""
    run = simulator.run(problem.driving_records, Pass(whole_records(problem.records), problem.values, problem.initial))
    return [np.array(run.y[e, :n]) for e, n in enumerate(problem.records.lengths)]


def visited_states(problem: Problem, simulator: Simulator) -> list[np.ndarray]:
    """States (N_e, n_x) that every experiment runs through from its start state."""
    run = simulator.run(
        problem.driving_records, Pass(whole_records(problem.records), problem.values, problem.initial, keep_states=True)
    )
    assert run.states is not None
    return [run.states[e, :n] for e, n in enumerate(problem.records.lengths)]


@dataclass(frozen=True)
class FreeRun:
    """Unknowns of a problem as one vector z: free parameters, then free start states experiment by experiment."""

    problem: Problem
    simulator: Simulator

    @property
    def n_parameters(self) -> int:
        """How many of the unknowns are parameters."""
        return int(self.problem.free.sum())

    @property
    def start(self) -> np.ndarray:
        """The unknowns (d,) as the problem has them."""
        free_states = self.problem.initial[:, self.problem.initial_free]
        return np.concatenate([self.problem.values[self.problem.free], free_states.ravel()])

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper bounds (d,) of the unknowns; start states have none."""
        open_ended = np.full(len(self.start) - self.n_parameters, np.inf)
        low = np.concatenate([self.problem.lower[self.problem.free], -open_ended])
        return low, np.concatenate([self.problem.upper[self.problem.free], open_ended])

    def at(self, z: np.ndarray) -> Problem:
        """The problem with its unknowns set to ``z``."""
        values, initial = self.problem.values.copy(), self.problem.initial.copy()
        values[self.problem.free] = z[: self.n_parameters]
        initial[:, self.problem.initial_free] = z[self.n_parameters :].reshape(len(initial), -1)
        return self.problem.with_values(values, initial)

    def admissible(self, z: np.ndarray) -> bool:
        """Whether the model's joint constraints hold at ``z``."""
        return self.problem.admissible(self.at(z).values)

    def quadratic(self, z: np.ndarray) -> Quadratic[None] | None:
        """Cost, gradient and Gauss-Newton Hessian at ``z``; None where the simulation is not finite."""
        normals = self.normals(z)
        if normals is None:
            return None
        return self.assembled([stretches.sum(axis=0) for stretches in normals], None)

    def assembled(self, matrices: Sequence[np.ndarray], extra: Extra) -> Quadratic[Extra]:
        """Cost, gradient and Hessian in all unknowns from [J e]ᵀ[J e] (d_e + 1, d_e + 1) of every experiment."""
        size, n_p = len(self.start), self.n_parameters
        cost, gradient, hessian = 0.0, np.zeros(size), np.zeros((size, size))
        for e, matrix in enumerate(matrices):
            index = self.columns(e, n_p, matrix.shape[0] - 1 - n_p)
            hessian[np.ix_(index, index)] += matrix[:-1, :-1]
            gradient[index] -= matrix[:-1, -1]
            cost += 0.5 * float(matrix[-1, -1])
        return Quadratic(cost, gradient, hessian, extra)

    def normals(self, z: np.ndarray) -> list[np.ndarray] | None:
        """Gauss-Newton matrices (C_e, d_e + 1, d_e + 1) of every experiment, stretch by stretch, see :class:`ParallelRun`."""
        point = self.at(z)
        records = point.driving_records
        return self._parallel.normals(records, point.values, point.initial, self._rough, self.problem.weights)

    def errors(self, z: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]] | None:
        """Weighted errors (N_e, n_y) and sensitivities (N_e, n_y, d_e) of every experiment, sample by sample, see :class:`ParallelRun`."""
        point = self.at(z)
        records = point.driving_records
        return self._parallel.errors(records, point.values, point.initial, self._rough, self.problem.weights)

    def by_samples(self, z: np.ndarray) -> np.ndarray | None:
        """The Gauss-Newton Hessian (d, d) at ``z`` from the sensitivities of every sample, which cancel nothing, as windows of it may.

        None where the simulation is not finite, or there are more than :data:`MOST_SENSITIVITIES`.
        """
        own = self.n_parameters + int(self.problem.initial_free.sum())  # of one experiment, as the arrays have them
        if self.problem.records.y.size * own > MOST_SENSITIVITIES:
            return None
        found = self.errors(z)
        if found is None:
            return None
        size, hessian = len(z), np.zeros((len(z), len(z)))
        for e, (_, slopes) in enumerate(found):
            rows = slopes.reshape(-1, slopes.shape[-1])
            index = self.columns(e, self.n_parameters, (size - self.n_parameters) // len(found))
            hessian[np.ix_(index, index)] += rows.T @ rows
        return hessian if np.isfinite(hessian).all() else None

    @property
    def stretch(self) -> int:
        """Samples of each stretch that :meth:`normals` is by; the last one of an experiment may be shorter."""
        return self._parallel.links.windows.steps

    @cached_property
    def _parallel(self) -> ParallelRun:
        estimated = np.flatnonzero(self.problem.free)
        return ParallelRun(self.simulator, self.problem.records, estimated, self.problem.free_states)

    @cached_property
    def _rough(self) -> np.ndarray:
        return rough_starts(self.problem, self._parallel.links.windows)

    @staticmethod
    def columns(experiment: int, n_p: int, n_s: int) -> np.ndarray:
        """Which unknowns an experiment depends on."""
        own = n_p + experiment * n_s
        return np.concatenate([np.arange(n_p), np.arange(own, own + n_s)])


def descended(run: FreeRun, start: np.ndarray, settings: Settings) -> Optimum[None] | None:
    """The optimum that a run reaches from its unknowns ``start`` (d,); None where that cannot be simulated."""
    return minimise(run.quadratic, start, *run.bounds, settings=settings, admissible=run.admissible)
