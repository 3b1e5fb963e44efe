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
    draws = [(k,) for k in range(SAFE + 1)]
    taken: list[int] = []
    monkeypatch.setattr(module, "driven_under", lambda own, commands, step: commands)
    monkeypatch.setattr(module, "keeps", lambda one, *given: [one != leaves])
    monkeypatch.setattr(module, "_nats", lambda aim, own, *given: taken.append(own[0]) or np.full((2, 2), 5.0))
    found = judged(stub(decided=lambda nats: 0.6), draws, Trial((), np.zeros((1, 3)), 0.0), np.arange(3.0), stub())
    assert found.score == pytest.approx(0.6 - cost) and found.nats == pytest.approx(np.full((2, 2), 5.0))
    assert taken == list(range(DRAWS + 1))


def test_so_many_draws_beside_the_estimates() -> None:
    rng_values: list[float] = []
    one = stub(drawn=lambda rng: rng_values.append(rng.normal()) or "drawn")
    draws = draws_of(stub(contenders=(one,)), seed=1)
    assert draws[0] == (one,) and len(draws) == SAFE + 1 and len(set(rng_values)) == SAFE
