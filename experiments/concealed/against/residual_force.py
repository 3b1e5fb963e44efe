"""The force that a model lacks at a port, sample by sample, with the hidden states beside it: a smoother.

A sparse regression wants states and accelerations; one sensor shows neither. This is the fairest stand-in: of all trajectories of the
plain model with an extra force d at one port that wanders at random, the most likely one given the measurement. It minimises

    Σ ((y_k − h(x_k)) / σ)² + Σ ((x_{k+1} − Φ(x_k, d_k)) / s)² + Σ ((d_{k+1} − d_k) / q)² + Σ (d_k / D)²

over all states x_k and forces d_k at once by Gauss-Newton; the normal equations are block tridiagonal. σ is the noise of the sensor, s a
thousandth of how far a state moves in a sample, q how far the force may wander in one, D so large a force that it matters only where the
measurement says nothing (a constant torque in a spring is the same as a constant twist).

Source: B. M. Bell, "The iterated Kalman smoother as a Gauss-Newton method", SIAM J. Optimization 4(3), 1994; unknown forces as random
walks: N. R. Kristensen, H. Madsen, S. B. Jørgensen, "A method for systematic improvement of stochastic grey-box models", Computers and
Chemical Engineering 28, 2004.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solveh_banded

from experiments.concealed.against.plain import Plain
from greybox_torch import Mechanism, Parameter, Probe, Signals, Surroundings
from greybox_torch.estimate import problem_for
from greybox_torch.mechanisms import AugmentedModel, attach
from greybox_torch.simulation import Pass, Windows

SLACK = 1e-3
"""Share of a state's movement in a sample by which the model may be wrong elsewhere than at the port."""

LARGEST = 30.0
"""D, in units of the forces that act on the port already."""

SWEEPS = 4
"""Gauss-Newton steps from the first guess; the smoother is a start for a regression, not a result."""


class Disturbance(Mechanism):
    """A force d, whatever it may be: its value is set sample by sample."""

    name = "disturbance"
    kinds = ("body", "coupling", "balance", "actuator")

    def parameters(self, around: Surroundings) -> list[Parameter]:
        return [Parameter("d", 0.0, around.force_unit)]

    def force(self, s: Signals, p: Signals, z: Signals) -> object:
        return p.d

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe(("d",))]


@dataclass(frozen=True)
class Smoothed:
    """States (N, n_x) and missing force (N,) along the estimation experiments."""

    states: np.ndarray
    force: np.ndarray


@dataclass(frozen=True)
class _Weights:
    """Inverses of s (n_x,), q and D, see above."""

    model: np.ndarray
    walk: float
    size: float


class Smoother:
    """The smoother for one port of a re-tuned model."""

    def __init__(self, plain: Plain, port: str) -> None:
        self.plain = plain
        model = AugmentedModel(
            plain.problem.model, [attach(plain.problem.model, port, Disturbance())], plain.surroundings
        )
        self.name = model.declared_parameters[-1].name
        self.problem = problem_for(plain.problem, model, {})
        self.simulator = plain.simulator.for_model(model, (self.name,))
        self.records = self.problem.driving_records
        count, n_x = self.records.u.shape[1], len(model.states)
        last = np.repeat(self.records.last, self.records.lengths)
        samples = np.arange(count)
        self.each = Windows(samples, np.minimum(samples + 1, last), 1)
        self.joined = samples < last  # whether a next sample belongs to the same experiment
        self.eye = np.broadcast_to(np.eye(n_x), (count, n_x, n_x))
        self.values = np.tile(self.problem.values, (count, 1))

    def start(self) -> Smoothed:
        """The trajectories of short windows without any force, to begin with."""
        fit = self.plain.windows
        run = self.plain.simulator.run(
            fit.problem.driving_records, Pass(fit.windows, fit.problem.values, fit.starts, keep_states=True)
        )
        assert run.states is not None
        sizes = np.diff(np.append(fit.windows.start, self.records.u.shape[1]))
        states = np.concatenate([s[:n] for s, n in zip(run.states, sizes, strict=True)])
        return Smoothed(states, np.zeros(len(states)))

    def run(self, begin: Smoothed, samples_to_wander: float) -> Smoothed:
        """The most likely trajectory.

        Args:
            samples_to_wander: after how many samples the force may be as large as the forces that act on the port already.
        """
        states, force = begin.states.copy(), begin.force.copy()
        weights = None
        for _ in range(SWEEPS):
            y, by_y, ahead, by_ahead = self._step(states, force)
            if weights is None:
                moved = np.sqrt(np.mean((ahead - states) ** 2, axis=0))
                slack = SLACK * np.maximum(moved, 1e-9 * np.abs(states).max(axis=0) + 1e-300)
                scale = self._scale(moved, by_ahead)
                weights = _Weights(1.0 / slack, np.sqrt(samples_to_wander) / scale, 1.0 / (LARGEST * scale))
            change = self._newton(states, force, y, by_y, ahead, by_ahead, weights)
            if not np.isfinite(change).all():
                break
            states, force = states + change[:, :-1], force + change[:, -1]
        return Smoothed(states, force)

    def _step(self, states: np.ndarray, force: np.ndarray) -> tuple[np.ndarray, ...]:
        """Outputs (N, n_y), the next states (N, n_x), and their derivatives over state and force (N, n_y or n_x, n_x + 1)."""
        self.values[:, -1] = force
        run = self.simulator.run(
            self.records, Pass(self.each, self.values, states, tangents=True, start_directions=self.eye)
        )
        assert run.dy is not None and run.dx_end is not None
        order = np.roll(np.arange(states.shape[1] + 1), -1)  # the force's direction comes first
        return run.y[:, 0], run.dy[:, 0][..., order], run.x_end, np.swapaxes(run.dx_end, 1, 2)[..., order]

    @staticmethod
    def _scale(moved: np.ndarray, by_ahead: np.ndarray) -> float:
        """The force that moves some state in a sample as far as it moves anyway."""
        push = np.sqrt(np.mean(by_ahead[..., -1] ** 2, axis=0))
        return float(np.min(np.where(push > 1e-6 * push.max(), moved / np.maximum(push, 1e-300), np.inf)))

    def _newton(
        self,
        states: np.ndarray,
        force: np.ndarray,
        y: np.ndarray,
        by_y: np.ndarray,
        ahead: np.ndarray,
        by_ahead: np.ndarray,
        weights: _Weights,
    ) -> np.ndarray:
        """The Gauss-Newton step (N, n_x + 1) in states and force."""
        count, n_x = states.shape
        size = n_x + 1
        error = (np.nan_to_num(self.records.y.T - y)) / self.plain.noise
        slope = by_y / self.plain.noise[:, None] * ~np.isnan(self.records.y.T)[..., None]
        diagonal = np.swapaxes(slope, 1, 2) @ slope
        gradient = (np.swapaxes(slope, 1, 2) @ error[..., None])[..., 0]
        now = np.zeros((count, size, size))  # the links to the next sample, by the state and the force of this one
        now[:, :n_x] = -by_ahead * weights.model[:, None]
        now[:, n_x, n_x] = -weights.walk
        now[~self.joined] = 0.0
        following = np.diag(np.append(weights.model, weights.walk))
        gap = np.zeros((count, size))
        gap[:-1, :n_x] = (states[1:] - ahead[:-1]) * weights.model
        gap[:-1, n_x] = np.diff(force) * weights.walk
        gap[~self.joined] = 0.0
        diagonal = diagonal + np.swapaxes(now, 1, 2) @ now
        diagonal[1:] += self.joined[:-1, None, None] * (following @ following)
        gradient -= (np.swapaxes(now, 1, 2) @ gap[..., None])[..., 0]
        gradient[1:] -= self.joined[:-1, None] * (gap[:-1] @ following)
        diagonal[:, n_x, n_x] += weights.size**2
        gradient[:, n_x] -= weights.size**2 * force
        return solved(diagonal, following @ now[:-1], gradient)


def solved(diagonal: np.ndarray, below: np.ndarray, right: np.ndarray) -> np.ndarray:
    """The solution (N, m) of a symmetric block tridiagonal system with blocks (N, m, m) on and (N − 1, m, m) below the diagonal."""
    count, size = right.shape
    bands = np.zeros((2 * size, count, size))
    for i in range(size):
        for j in range(size):
            if i >= j:
                bands[i - j, :, j] = diagonal[:, i, j]
            bands[size + i - j, :-1, j] = below[:, i, j]
    ridge = 1e-12 * bands[0].max(axis=0)
    bands[0] += ridge  # a state that nothing determines stays where it is
    return solveh_banded(bands.reshape(2 * size, -1), right.ravel(), lower=True, check_finite=False).reshape(
        count, size
    )
