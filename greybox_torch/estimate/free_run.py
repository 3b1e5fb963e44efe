"""The free run of whole experiments: simulation, cost, and Gauss-Newton matrices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.estimate.levenberg_marquardt import Quadratic
from greybox_torch.estimate.problem import Problem
from greybox_torch.simulate.stepper import Run, Stepper, whole_records


def simulate(problem: Problem, stepper: Stepper, *, substeps: int = 1) -> list[np.ndarray]:
    """Simulated outputs (N_e, n_y) of every experiment from its start state."""
    run = stepper.run(
        problem.driving_tape, whole_records(problem.tape), problem.values, problem.initial, substeps=substeps
    )
    return [np.array(run.y[e, :n]) for e, n in enumerate(problem.tape.lengths)]


@dataclass(frozen=True)
class FreeRun:
    """Unknowns of a problem as one vector z: free parameters, then free start states experiment by experiment."""

    problem: Problem
    stepper: Stepper
    substeps: int = 1

    @property
    def n_parameters(self) -> int:
        return int(self.problem.free.sum())

    @property
    def start(self) -> np.ndarray:
        free_states = self.problem.initial[:, self.problem.initial_free]
        return np.concatenate([self.problem.values[self.problem.free], free_states.ravel()])

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
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
        return self.problem.admissible(self.at(z).values)

    def quadratic(self, z: np.ndarray) -> Quadratic[None] | None:
        """Cost, gradient and Gauss-Newton Hessian at ``z``; None where the simulation is not finite."""
        run = self._run(z, self.problem.weights)
        assert run.normal is not None
        if not np.isfinite(run.normal).all():
            return None
        size, n_p = len(z), self.n_parameters
        gradient, hessian = np.zeros(size), np.zeros((size, size))
        for e, matrix in enumerate(run.normal):
            index = self.columns(e, n_p, matrix.shape[0] - 1 - n_p)
            hessian[np.ix_(index, index)] += matrix[:-1, :-1]
            gradient[index] -= matrix[:-1, -1]
        return Quadratic(0.5 * float(run.normal[:, -1, -1].sum()), gradient, hessian, None)

    def residuals(self, z: np.ndarray) -> tuple[list[np.ndarray], list[np.ndarray]]:
        """Weighted errors simulated − measured (M_e,) per experiment and their Jacobian (M_e, d_e), at a point that simulates.

        The columns of an experiment are the free parameters, then its own free start states.
        """
        run, tape, weights = self._run(z, None), self.problem.tape, self.problem.weights
        errors, jacobians = [], []
        for e, n in enumerate(tape.lengths):
            measured = tape.y[:, tape.span(e)].T
            known = ~np.isnan(measured)
            errors.append(((run.y[e, :n] - measured) * weights)[known])
            jacobians.append(
                np.zeros((known.sum(), 0)) if run.dy is None else (run.dy[e, :n] * weights[:, None])[known]
            )
        return errors, jacobians

    def _run(self, z: np.ndarray, weights: np.ndarray | None) -> Run:
        point = self.at(z)
        tape, states = point.driving_tape, point.free_states
        directions = np.zeros((len(tape.first), len(states), point.initial.shape[1]))
        directions[:, np.arange(len(states)), states] = 1.0
        return self.stepper.run(
            tape,
            whole_records(tape),
            point.values,
            point.initial,
            tangents=True,
            start_directions=directions,
            substeps=self.substeps,
            weights=weights,
        )

    @staticmethod
    def columns(experiment: int, n_p: int, n_s: int) -> np.ndarray:
        """Which unknowns an experiment depends on."""
        own = n_p + experiment * n_s
        return np.concatenate([np.arange(n_p), np.arange(own, own + n_s)])
