"""Free runs with sensitivities, parallel over windows, each evaluation begun from what the best one before has taught."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from greybox_torch.simulation.continuous import Chain, chain, continuous, propagated, sequential_starts
from greybox_torch.simulation.passes import Pass, Run
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import Simulator


@dataclass(frozen=True)
class _Known:
    """Where a trajectory was evaluated, its window starts (W, n_x), their transitions (W, n_x, n_t) and derivatives (W, n_d, n_x)."""

    cost: float
    p: np.ndarray
    x0: np.ndarray
    starts: np.ndarray
    transitions: np.ndarray
    slopes: np.ndarray


@dataclass
class ParallelRun:
    """Gauss-Newton matrices of free runs of the same records at parameters and start states that change little by little.

    Args:
        records: where the experiments lie; the records that drives a run may differ from it in its signals.
        estimated: indices of the parameters that the stepper has tangents for.
        states: indices of the states whose start value varies.
    """

    simulator: Simulator
    records: Records
    estimated: np.ndarray
    states: np.ndarray
    links: Chain = field(init=False)
    _known: _Known | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        self.links = chain(self.records)

    def normals(
        self, records: Records, p: np.ndarray, x0: np.ndarray, rough: np.ndarray, weights: np.ndarray
    ) -> list[np.ndarray] | None:
        """Of every experiment, window by window, the matrices (C_e, n_d + 1, n_d + 1) of [J e]ᵀ[J e].

        J are the sensitivities of the weighted outputs to the n_d unknowns (estimated parameters, then the experiment's own varying start
        states), e the weighted errors measured − simulated.

        Args:
            records: the records that drives the run and holds the measurement.
            p: parameters (n_p,).
            x0: start states (E, n_x).
            rough: window starts (W, n_x) to begin with where nothing better is known.

        Returns:
            None where the simulation is not finite.
        """
        found = self._run(records, p, x0, rough, weights)
        if found is None:
            return None
        run, starts, slopes = found
        assert run.normal is not None
        with np.errstate(all="ignore"):
            normal = _condensed(run.normal, slopes, len(self.estimated))
        if not np.isfinite(normal).all():
            return None
        self._learn(float(normal[:, -1, -1].sum()), p, x0, run, starts, slopes)
        return [normal[row[row >= 0]] for row in self.links.order]

    def errors(
        self, records: Records, p: np.ndarray, x0: np.ndarray, rough: np.ndarray, weights: np.ndarray
    ) -> list[tuple[np.ndarray, np.ndarray]] | None:
        """Of every experiment, sample by sample, the weighted errors e (N_e, n_y) and sensitivities J (N_e, n_y, n_d), see :meth:`normals`.

        Both are zero where the measurement is missing.
        """
        found = self._run(records, p, x0, rough, None)
        if found is None:
            return None
        run, starts, slopes = found
        assert run.dy is not None
        n_p, steps = len(self.estimated), self.links.windows.steps
        with np.errstate(all="ignore"):
            dy = np.einsum("wkys,wds->wkyd", run.dy[:, :, :, n_p:], slopes)
            dy[..., :n_p] += run.dy[..., :n_p]
        result = []
        for e, row in enumerate(self.links.order):
            own, measured = row[row >= 0], records.y[:, records.span(e)].T
            known = ~np.isnan(measured)
            y = run.y[own, :steps].reshape(-1, measured.shape[1])[: len(known)]
            slope = dy[own, :steps].reshape(-1, *dy.shape[2:])[: len(known)]
            if not (np.isfinite(y).all() and np.isfinite(slope).all()):
                return None
            errors = np.where(known, measured - y, 0.0) * weights
            result.append((errors, np.where(known[:, :, None], slope, 0.0) * weights[:, None]))
        self._learn(sum(float((e**2).sum()) for e, _ in result), p, x0, run, starts, slopes)
        return result

    def _run(
        self, records: Records, p: np.ndarray, x0: np.ndarray, rough: np.ndarray, weights: np.ndarray | None
    ) -> tuple[Run, np.ndarray, np.ndarray] | None:
        """A pass over the windows of the continuous trajectory, its window starts (W, n_x), and their derivatives (W, n_d, n_x)."""
        starts = self._starts(records, p, x0, rough)
        if not np.isfinite(starts).all():
            return None
        count, n_x = starts.shape
        run = self.simulator.run(
            records,
            Pass(
                self.links.windows,
                p,
                starts,
                tangents=len(self.estimated) > 0,
                start_directions=np.broadcast_to(np.eye(n_x), (count, n_x, n_x)),
                weights=weights,
            ),
        )
        assert run.dx_end is not None
        n_p = len(self.estimated)
        own = np.zeros((count, n_p + len(self.states), run.dx_end.shape[2]))
        own[:, :n_p] = run.dx_end[:, :n_p]
        first = np.zeros((len(x0), n_p + len(self.states), n_x))
        first[:, n_p + np.arange(len(self.states)), self.states] = 1.0
        with np.errstate(all="ignore"):
            slopes = propagated(self.links, first, own, run.dx_end[:, n_p:])
        return run, starts, slopes

    def _learn(
        self, cost: float, p: np.ndarray, x0: np.ndarray, run: Run, starts: np.ndarray, slopes: np.ndarray
    ) -> None:
        """Keep the best trajectory so far, which the next one begins from."""
        if self._known is None or cost <= self._known.cost:
            assert run.dx_end is not None
            self._known = _Known(cost, p, x0, starts, run.dx_end[:, len(self.estimated) :], slopes)

    def _starts(self, records: Records, p: np.ndarray, x0: np.ndarray, rough: np.ndarray) -> np.ndarray:
        """Window starts (W, n_x) of the continuous trajectory; not finite where it overflows."""
        guess, transitions = rough, None
        if self._known is not None:
            known = self._known
            moved = np.concatenate(
                [
                    np.broadcast_to((p - known.p)[self.estimated], (len(x0), len(self.estimated))),
                    (x0 - known.x0)[:, self.states],
                ],
                axis=1,
            )
            guess = known.starts + np.einsum("wd,wdx->wx", moved[self.links.experiment], known.slopes)
            transitions = known.transitions
        found = continuous(self.simulator, records, self.links, p, x0, guess=guess, transitions=transitions)
        if found is not None:
            return found.starts
        return sequential_starts(self.simulator, records, self.links, p, x0)


def _condensed(normal: np.ndarray, slopes: np.ndarray, n_p: int) -> np.ndarray:
    """Normal matrices (W, n_p + n_x + 1, ·) of parameters and window starts as those (W, n_d + 1, ·) of the n_d unknowns."""
    count, n_d, n_x = slopes.shape
    lift = np.zeros((count, n_d + 1, n_p + n_x + 1))
    lift[:, np.arange(n_p), np.arange(n_p)] = 1.0
    lift[:, :n_d, n_p : n_p + n_x] = slopes
    lift[:, -1, -1] = 1.0
    return lift @ normal @ np.swapaxes(lift, 1, 2)
