"""Inputs judged under draws of the hypotheses' parameters."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from greybox_torch.experiment_design import judged as module
from greybox_torch.experiment_design.aim import Trial
from greybox_torch.experiment_design.judged import DRAWS, OUTSIDE, SAFE, draws_of, judged

stub: Any = SimpleNamespace


@pytest.mark.parametrize(("leaves", "cost"), [(None, 0.0), (1, OUTSIDE), (SAFE, OUTSIDE)])
def test_an_input_keeps_the_limits_under_every_draw(monkeypatch, leaves: int | None, cost: float) -> None:
    """Also under the many draws that are simulated only for the limits; the evidence is taken from the first few."""
    model = stub(states=[])
    draws = [(stub(problem=stub(values=np.array([k]), model=model), level=[1.0]),) for k in range(SAFE + 1)]
    taken: list[int] = []

    def evidence(aim, own, *given):
        taken.extend(int(one.problem.values[0]) for (one,) in own)
        return [np.full((2, 2), 5.0)] * len(own)

    monkeypatch.setattr(module, "driven_under", lambda own, commands, step: commands)
    monkeypatch.setattr(module, "keeps", lambda one, limits, inputs, time, values: values[:, 0] != leaves)
    monkeypatch.setattr(module, "_nats", evidence)
    found = judged(stub(decided=lambda nats: 0.6), draws, Trial((), np.zeros((1, 3)), 0.0), np.arange(3.0), stub())
    assert found.score == pytest.approx(0.6 - cost) and found.nats == pytest.approx(np.full((2, 2), 5.0))
    assert taken == list(range(DRAWS + 1))


def test_so_many_draws_beside_the_estimates() -> None:
    rng_values: list[float] = []
    one = stub(drawn=lambda rng: rng_values.append(rng.normal()) or "drawn")
    draws = draws_of(stub(contenders=(one,)), seed=1)
    assert draws[0] == (one,) and len(draws) == SAFE + 1 and len(set(rng_values)) == SAFE
