"""Free runs of several experiments and their scores."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greybox_torch.estimate.comparison import compare
from greybox_torch.estimate.problem import make_problem
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.simulator import Simulator
from tests.estimate.bench_motor import UNITS


def test_comparison(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    data = data_set(UNITS, experiments, roles=["estimation", "validation"], initial={"speed": {"value": 0.0}})
    problem = make_problem(data, motor, data.recordings).with_values(np.array([0.02, 0.1, 0.05]))
    found = compare(problem, data.recordings, Simulator.of(motor, ()))
    assert [(s.experiment, s.role, s.output) for s in found.scores] == [
        ("run 1", "estimation", "speed"),
        ("run 2", "validation", "speed"),
    ]
    assert [s.fit for s in found.scores] == pytest.approx([100.0, 100.0], abs=1e-3)
    assert [run.shape for run in found.simulated] == [(400, 1), (240, 1)]
    as_given = compare(problem, data.recordings, Simulator.of(motor, ()), estimate_starts=False)
    assert max(s.fit for s in as_given.scores) < 99.0
