"""Many machines of one model on inputs of their own, simulated block by block."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from greybox_torch.estimate.problem import Problem
from greybox_torch.experiment_design.side_by_side import begun_each, prepared_each, records_of
from greybox_torch.mechanisms.delayed_input import CHANNELS
from greybox_torch.simulation.passes import Pass, Run
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import Windows


@dataclass(frozen=True)
class Machines:
    """One model with several rows of parameters (C, n_p), simulated block by block."""

    problem: Problem
    simulator: Simulator
    values: np.ndarray
    step: float
    _kept: dict[bytes, np.ndarray] = field(default_factory=dict)

    def run(self, u: np.ndarray, at: int, end: int, starts: np.ndarray | None) -> Run:
        """The samples from ``at`` to ``end`` on inputs (n_u, C, N), from states (C, n_x); from where a recording begins without them."""
        begin = max(0, at - self.reach)
        records = prepared_each(self.problem.model, self._records(u[:, :, begin:end]), self.values)
        first = records.first + (at - begin)
        if starts is None:
            starts = self._started(records, first)
        windows = Windows(first, records.last, end - at)
        with np.errstate(all="ignore"):
            return self.simulator.run(records, Pass(windows, self.values, starts, keep_states=True))

    @cached_property
    def reach(self) -> int:
        """Samples before the present one that act on it, by delays of the model's inputs."""
        names = [i.name.rpartition(".")[2].partition("@")[0] for i in self.problem.model.inputs]
        rows = [k for k, name in enumerate(names) if name == CHANNELS[2]]
        if not rows:
            return 0
        like = self._records(np.zeros((len(self.problem.records.u), 1, 2)))
        longest = max(self.problem.model.prepared(like, row).u[rows].max() for row in self.values)
        return int(np.ceil(longest / self.step)) + 1

    def _records(self, u: np.ndarray) -> Records:
        return records_of(list(np.moveaxis(u, 1, 0)), self.problem.records, self.step)

    def _started(self, records: Records, first: np.ndarray) -> np.ndarray:
        """Start states (C, n_x): those of the first recording, and of memories as the inputs say; kept while these begin alike."""
        inputs = records.u[:, first].tobytes()
        if inputs not in self._kept:
            self._kept.clear()
            own = np.repeat(self.problem.initial[:1], len(first), axis=0)
            self._kept[inputs] = begun_each(self.problem.model, own, records, first, self.values)
        return self._kept[inputs]
