"""Free runs of many machines of one model in one batch: every experiment in a lane of its own, with the parameters of its machine.

A single free run is cut into windows to fill the lanes of a processor, and costs several passes until its trajectory is continuous (see
:mod:`greybox_torch.simulation.continuous`). Many machines fill the lanes by themselves: one pass over whole records gives the cost,
gradient and Gauss-Newton Hessian of all.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.levenberg_marquardt import Quadratic
from greybox_torch.estimate.problem import Problem
from greybox_torch.simulation.passes import Pass, Run
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import Windows


@dataclass(frozen=True)
class Lanes:
    """Some experiments: whose they are (L,), which of its own each is (L,), and the stretches of the joined records."""

    owner: np.ndarray
    experiment: np.ndarray
    windows: Windows


@dataclass(frozen=True)
class FreeRuns:
    """Problems of one model with the same unknowns, machine by machine.

    ``simulator`` has tangents for their free parameters; ``substeps`` (M,) are those of every machine. Effects that shift signals in time
    are not simulated in a batch, see :func:`together`.
    """

    problems: tuple[Problem, ...]
    simulator: Simulator
    substeps: tuple[int, ...]

    @cached_property
    def runs(self) -> tuple[FreeRun, ...]:
        """The free run of every machine by itself."""
        simulators = {s: self.simulator.with_substeps(s) for s in set(self.substeps)}
        return tuple(FreeRun(p, simulators[s]) for p, s in zip(self.problems, self.substeps, strict=True))

    @cached_property
    def records(self) -> Records:
        """The records of all machines, one after the other."""
        return joined([problem.records for problem in self.problems])

    @cached_property
    def _first(self) -> np.ndarray:
        """Where the experiments of every machine begin among all (M + 1,)."""
        return np.concatenate([[0], np.cumsum([len(p.records.first) for p in self.problems])])

    def quadratics(self, points: Mapping[int, np.ndarray]) -> dict[int, Quadratic[None] | None]:
        """By machine: cost, gradient and Gauss-Newton Hessian at its ``points`` (d,); None where its simulation is not finite."""
        found: dict[int, Quadratic[None] | None] = {}
        at = {m: self.runs[m].at(z) for m, z in points.items()}
        for substeps, machines in self._alike(points):
            lanes = self._lanes(machines)
            normals = self._normals(lanes, at, self.simulator.with_substeps(substeps))
            for m in machines:
                own = normals[lanes.owner == m]
                found[m] = self.runs[m].assembled(list(own), None) if np.isfinite(own).all() else None
        return found

    def allowed(self, points: Mapping[int, np.ndarray]) -> dict[int, bool]:
        """By machine: whether the model's joint constraints hold at its ``points`` (d,)."""
        rows = np.array([self.runs[m].at(z).values for m, z in points.items()])
        return dict(zip(points, map(bool, self.problems[0].all_admissible(rows)), strict=True))

    def simulated(self, machines: Iterable[int], *, steps: Mapping[int, int] | None = None) -> dict[int, np.ndarray]:
        """By machine: simulated outputs (E, N, n_y) of its experiments, the longest of N samples; beyond the end of one they mean nothing.

        Args:
            steps: of how many samples, where not of the longest experiment.
        """
        found: dict[int, np.ndarray] = {}
        wanted = steps or {m: int(self.problems[m].records.lengths.max()) for m in machines}
        for substeps, some in self._alike(machines):
            lanes = self._lanes(some, max(wanted[m] for m in some))
            run = self._run(lanes, dict(enumerate(self.problems)), self.simulator.with_substeps(substeps))
            found |= {m: np.array(run.y[lanes.owner == m, : wanted[m]]) for m in some}
        return found

    def with_substeps(self, substeps: Sequence[int]) -> FreeRuns:
        """The same machines with so many Runge-Kutta steps per sample (M,)."""
        other = FreeRuns(self.problems, self.simulator, tuple(substeps))
        other.__dict__["records"] = self.records
        return other

    def _alike(self, machines: Iterable[int]) -> list[tuple[int, list[int]]]:
        """Machines of the same sub-steps and of about the same length (within a factor of two): a pass is as long as its longest lane."""
        groups: dict[tuple[int, int], list[int]] = {}
        for m in machines:
            length = int(self.problems[m].records.lengths.max())
            groups.setdefault((self.substeps[m], length.bit_length()), []).append(m)
        return [(substeps, some) for (substeps, _), some in groups.items()]

    def _lanes(self, machines: Sequence[int], steps: int | None = None) -> Lanes:
        of = [np.arange(self._first[m], self._first[m + 1]) for m in machines]
        index = np.concatenate(of)
        steps = int(self.records.lengths[index].max()) if steps is None else steps
        windows = Windows(self.records.first[index], self.records.last[index], steps)
        return Lanes(np.repeat(machines, [len(o) for o in of]), np.concatenate([o - o[0] for o in of]), windows)

    def _run(self, lanes: Lanes, at: Mapping[int, Problem], simulator: Simulator, **asked: Any) -> Run:
        p = np.array([at[m].values for m in lanes.owner])
        x0 = np.array([at[m].initial[e] for m, e in zip(lanes.owner, lanes.experiment, strict=True)])
        return simulator.run(self.records, Pass(lanes.windows, p, x0, **asked))

    def _normals(self, lanes: Lanes, at: Mapping[int, Problem], simulator: Simulator) -> np.ndarray:
        """[J e]ᵀ[J e] (L, d_e + 1, d_e + 1) of every lane. Where machines weigh outputs differently, a pass for each output."""
        first = self.problems[0]
        count, n_x = len(lanes.owner), first.initial.shape[1]
        directions = np.broadcast_to(np.eye(n_x)[first.free_states], (count, len(first.free_states), n_x))
        asked: dict[str, Any] = {"tangents": bool(first.free.any()), "start_directions": directions}
        weights = np.array([self.problems[m].weights for m in lanes.owner])
        if (weights == weights[0]).all():
            normal = self._run(lanes, at, simulator, weights=weights[0], **asked).normal
            assert normal is not None
            return normal
        total: Any = 0.0
        for k in range(weights.shape[1]):
            normal = self._run(lanes, at, simulator, weights=np.eye(weights.shape[1])[k], **asked).normal
            assert normal is not None
            total = total + normal * weights[:, k, None, None] ** 2
        return total


def alike(problems: Sequence[Problem]) -> list[list[int]]:
    """The indices of those that :class:`FreeRuns` takes together: with the same unknowns and the same hold of inputs."""
    groups: dict[Hashable, list[int]] = {}
    for m, problem in enumerate(problems):
        key = (problem.free.tobytes(), problem.initial_free.tobytes(), problem.records.hold, id(problem.model))
        groups.setdefault(key, []).append(m)
    return list(groups.values())


def together(problem: Problem) -> bool:
    """Whether a problem can be simulated in a batch: what drives it does not depend on its parameters."""
    return problem.driving_records is problem.records


def joined(records: Sequence[Records]) -> Records:
    """The records of several machines, one after the other."""
    offsets = np.concatenate([[0], np.cumsum([len(r.dt) for r in records])[:-1]]).astype(np.int64)
    return Records(
        u=np.concatenate([r.u for r in records], axis=1),
        y=np.concatenate([r.y for r in records], axis=1),
        dt=np.concatenate([r.dt for r in records]),
        first=np.concatenate([r.first + o for r, o in zip(records, offsets, strict=True)]),
        last=np.concatenate([r.last + o for r, o in zip(records, offsets, strict=True)]),
        names=tuple(name for r in records for name in r.names),
        hold=records[0].hold,
    )


def whole(problem: Problem, simulated: np.ndarray) -> list[np.ndarray]:
    """Simulated outputs (N_e, n_y) of every experiment, from those (E, N, n_y) of all."""
    return [simulated[e, :n] for e, n in enumerate(problem.records.lengths)]
