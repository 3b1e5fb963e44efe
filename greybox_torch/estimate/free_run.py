"""The free run of whole experiments: simulation, cost, and Gauss-Newton matrices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.estimate.levenberg_marquardt import Quadratic
from greybox_torch.estimate.problem import Problem
from greybox_torch.simulate.stepper import Stepper, whole_records


def simulate(problem: Problem, stepper: Stepper, *, substeps: int = 1) -> list[np.ndarray]:
    """Simulated outputs (N_e, n_y) of every experiment from its start state."""
    run = stepper.run(problem.tape, whole_records(problem.tape), problem.values, problem.initial, substeps=substeps)
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

    def residuals(self, z: np.ndarray) -> tuple[list[np.ndarray], list[np.ndarray]] | None:
        """Weighted errors (M_e,) per experiment and their Jacobian (M_e, d_e); None where the simulation is not finite.

        The columns of an experiment are the free parameters, then its own free start states.
        """
        point = self.at(z)
        tape, states = point.tape, point.free_states
        directions = np.zeros((len(tape.first), len(states), point.initial.shape[1]))
        directions[:, np.arange(len(states)), states] = 1.0
        run = self.stepper.run(
            tape,
            whole_records(tape),
            point.values,
            point.initial,
            tangents=True,
            start_directions=directions,
            substeps=self.substeps,
        )
        assert run.dy is not None
        errors, jacobians = [], []
        for e, n in enumerate(tape.lengths):
            measured = tape.y[:, tape.span(e)].T
            known = ~np.isnan(measured)
            error = ((run.y[e, :n] - measured) * point.weights)[known]
            slope = (run.dy[e, :n] * point.weights[:, None])[known]
            if not (np.isfinite(error).all() and np.isfinite(slope).all()):
                return None
            errors.append(error)
            jacobians.append(slope)
        return errors, jacobians

    def quadratic(self, z: np.ndarray) -> Quadratic[None] | None:
        """Cost, gradient and Gauss-Newton Hessian at ``z``."""
        found = self.residuals(z)
        if found is None:
            return None
        size, n_p = len(z), self.n_parameters
        n_s = (size - n_p) // len(found[0])
        gradient, hessian, cost = np.zeros(size), np.zeros((size, size)), 0.0
        for e, (error, slope) in enumerate(zip(*found, strict=True)):
            index = self.columns(e, n_p, n_s)
            hessian[np.ix_(index, index)] += slope.T @ slope
            gradient[index] += slope.T @ error
            cost += 0.5 * float(error @ error)
        return Quadratic(cost, gradient, hessian, None)

    @staticmethod
    def columns(experiment: int, n_p: int, n_s: int) -> np.ndarray:
        """Which unknowns an experiment depends on."""
        own = n_p + experiment * n_s
        return np.concatenate([np.arange(n_p), np.arange(own, own + n_s)])
