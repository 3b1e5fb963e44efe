"""Levenberg-Marquardt from many start values at once: every member of a population is a lane of the same passes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.problem import Problem
from greybox_torch.linear_algebra import lengths, solve
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import Windows


@dataclass(frozen=True)
class Population:
    """M sets of parameters (M, n_p) and start states (M, E, n_x), and the cost ½‖r‖² (M,) of each; infinite where it overflows."""

    values: np.ndarray
    initial: np.ndarray
    cost: np.ndarray

    def __len__(self) -> int:
        return len(self.values)

    def selected(self, which: np.ndarray | slice) -> Population:
        """Some of them, by a mask, indices or a slice."""
        return Population(self.values[which], self.initial[which], self.cost[which])


@dataclass(frozen=True)
class Members:
    """The free runs of a population on the experiments of a problem; unknowns z (M, d) as in :class:`FreeRun`."""

    problem: Problem
    records: Records
    simulator: Simulator

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper bounds (d,) of the unknowns; start states have none."""
        free, open_ended = self.problem.free, np.full(len(self.records.first) * len(self.problem.free_states), np.inf)
        low = np.concatenate([self.problem.lower[free], -open_ended])
        return low, np.concatenate([self.problem.upper[free], open_ended])

    def unknowns(self, population: Population) -> np.ndarray:
        """The unknowns (M, d) of a population."""
        states = population.initial[:, :, self.problem.initial_free].reshape(len(population), -1)
        return np.concatenate([population.values[:, self.problem.free], states], axis=1)

    def at(self, population: Population, z: np.ndarray) -> Population:
        """The population with its unknowns set to ``z`` (M, d); costs are not known yet."""
        values, initial, n_p = population.values.copy(), population.initial.copy(), int(self.problem.free.sum())
        values[:, self.problem.free] = z[:, :n_p]
        initial[:, :, self.problem.initial_free] = z[:, n_p:].reshape(*initial.shape[:2], -1)
        return Population(values, initial, np.full(len(values), np.inf))

    def outputs(self, population: Population) -> np.ndarray:
        """Weighted outputs (M, E·K·n_y) of the free runs, zero where a sample is missing or beyond the end of an experiment."""
        rows, starts = self._lanes(population)
        y = self.simulator.run(self.records, Pass(self._windows(len(population)), rows, starts)).y
        recorded, known = self._recorded()
        y = np.where(known, y.reshape(len(population), *recorded.shape), 0.0) * self.problem.weights
        return y.reshape(len(population), -1)

    def costs(self, population: Population) -> np.ndarray:
        """Costs (M,) alone, which are quicker to come by; not finite where a run is not."""
        recorded, known = self._recorded()
        target = (np.where(known, recorded, 0.0) * self.problem.weights).ravel()
        with np.errstate(all="ignore"):
            return 0.5 * ((self.outputs(population) - target) ** 2).sum(axis=1)

    def normals(self, population: Population) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Costs (M,), gradients (M, d) and Gauss-Newton matrices (M, d, d); cost infinite where a run is not finite or not admissible."""
        rows, starts = self._lanes(population)
        count, experiments = population.initial.shape[:2]
        states, n_p = self.problem.free_states, int(self.problem.free.sum())
        directions = np.zeros((len(rows), len(states), starts.shape[1]))
        directions[:, np.arange(len(states)), states] = 1.0
        run = self.simulator.run(
            self.records,
            Pass(
                self._windows(count),
                rows,
                starts,
                tangents=True,
                start_directions=directions,
                weights=self.problem.weights,
            ),
        )
        assert run.normal is not None
        normal = run.normal.reshape(count, experiments, *run.normal.shape[1:])
        size = n_p + experiments * len(states)
        cost, gradient, hessian = np.zeros(count), np.zeros((count, size)), np.zeros((count, size, size))
        with np.errstate(invalid="ignore"):
            for e in range(experiments):
                index = FreeRun.columns(e, n_p, len(states))
                hessian[:, index[:, None], index] += normal[:, e, :-1, :-1]
                gradient[:, index] -= normal[:, e, :-1, -1]
                cost += 0.5 * normal[:, e, -1, -1]
        sound = np.isfinite(run.normal).all(axis=(1, 2)).reshape(count, experiments).all(axis=1)
        sound &= self.problem.all_admissible(population.values)
        return np.where(sound, cost, np.inf), gradient, hessian

    def _recorded(self) -> tuple[np.ndarray, np.ndarray]:
        """The measured outputs (E, K, n_y) side by side, and which are known: neither missing nor beyond the end of an experiment."""
        windows = self._windows(1)
        index = windows.start[:, None] + np.arange(windows.steps)
        recorded = np.moveaxis(self.records.y[:, np.minimum(index, windows.last[:, None])], 0, -1)
        return recorded, (index <= windows.last[:, None])[..., None] & ~np.isnan(recorded)

    def _lanes(self, population: Population) -> tuple[np.ndarray, np.ndarray]:
        experiments = population.initial.shape[1]
        return np.repeat(population.values, experiments, axis=0), population.initial.reshape(
            len(population) * experiments, -1
        )

    def _windows(self, count: int) -> Windows:
        return Windows(
            np.tile(self.records.first, count), np.tile(self.records.last, count), int(self.records.lengths.max())
        )


def sorted_by_cost(population: Population) -> Population:
    """Those that simulate, best first."""
    return population.selected(np.argsort(population.cost)[: int(np.isfinite(population.cost).sum())])


def improve(members: Members, population: Population, iterations: int, damping_at_first: float = 1e-2) -> Population:
    """``population`` after some Levenberg-Marquardt iterations each; a step that fails or does not pay is rejected for its member alone."""
    cost, gradient, hessian = members.normals(population)
    population = Population(population.values, population.initial, cost)
    low, high = members.bounds
    damping, growth = np.full(len(population), damping_at_first), np.full(len(population), 2.0)
    for _ in range(iterations):
        z = members.unknowns(population)
        step = _steps(z, np.isfinite(population.cost), gradient, hessian, damping, low, high)
        trial = members.at(population, np.clip(z + step, low, high))
        there = members.normals(trial)
        with np.errstate(invalid="ignore"):  # of members that were lost from the start
            taken = members.unknowns(trial) - z
        better = there[0] < population.cost
        gain = _gain(population.cost, there[0], gradient, hessian, taken)
        population = Population(
            np.where(better[:, None], trial.values, population.values),
            np.where(better[:, None, None], trial.initial, population.initial),
            np.where(better, there[0], population.cost),
        )
        gradient = np.where(better[:, None], there[1], gradient)
        hessian = np.where(better[:, None, None], there[2], hessian)
        damping = np.where(better, damping * np.clip(1.0 - (2.0 * gain - 1.0) ** 3, 0.1, 2.0), damping * growth)
        damping, growth = np.clip(damping, 1e-9, 1e12), np.where(better, 2.0, np.minimum(growth * 2.0, 1e6))
    return population


def _steps(
    z: np.ndarray,
    sound: np.ndarray,
    gradient: np.ndarray,
    hessian: np.ndarray,
    damping: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
) -> np.ndarray:
    """Damped Gauss-Newton steps (M, d), zero where a bound holds an unknown and for members that do not simulate."""
    held = ((z <= low) & (gradient > 0)) | ((z >= high) & (gradient < 0)) | ~sound[:, None]
    diagonal = np.where(sound[:, None], np.einsum("mii->mi", hessian), 1.0)
    scale = lengths(diagonal)
    matrix = np.where(held[:, :, None] | held[:, None, :], 0.0, hessian * scale[:, :, None] * scale[:, None, :])
    each = np.arange(z.shape[1])
    matrix[:, each, each] = np.where(held, 1.0, 1.0 + damping[:, None])
    right = np.where(held, 0.0, -gradient * scale)
    return scale * solve(matrix, right[..., None])[..., 0]


def _gain(
    before: np.ndarray, after: np.ndarray, gradient: np.ndarray, hessian: np.ndarray, taken: np.ndarray
) -> np.ndarray:
    """Achieved over predicted decrease (M,), within [0, 1]."""
    with np.errstate(all="ignore"):
        predicted = -np.einsum("mi,mi->m", gradient, taken) - 0.5 * np.einsum("mi,mij,mj->m", taken, hessian, taken)
        gain = (before - after) / predicted
    return np.clip(np.nan_to_num(gain, nan=0.0, posinf=1.0, neginf=0.0), 0.0, 1.0)
