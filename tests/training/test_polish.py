"""Which penalty the held-out stretches choose."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from greybox_torch.api.train_summary import penalty_at_an_end
from greybox_torch.training.polish import Choice, Polished, plainest
from greybox_torch.training.settings import TrainingSettings


@pytest.mark.parametrize(
    ("errors", "chosen"),
    [
        ({None: 1.0, 10.0: 0.99, 100.0: 0.995}, None),  # a gain of one per cent is none
        ({None: 1.0, 10.0: 0.5, 100.0: 0.505, 1000.0: 0.6}, 100.0),
        ({None: 1.0, 10.0: 0.5, 100.0: 0.9}, 10.0),
        ({None: 1.0, 10.0: float("inf")}, None),
        ({None: float("inf"), 10.0: 3.0}, 10.0),
    ],
)
def test_the_plainest_that_is_about_as_good(errors: dict[float | None, float], chosen: float | None) -> None:
    assert plainest([Choice(weight, error) for weight, error in errors.items()]).weight == chosen


@pytest.mark.parametrize(("chosen", "end"), [(10.0, "least"), (100.0, ""), (1000.0, "largest"), (None, "")], ids=str)
def test_a_penalty_at_the_end_of_those_tried_is_told(chosen: float | None, end: str) -> None:
    """Seen: "penalty 10 … chosen", the least of four, each ten times worse than the one before, without a word."""
    choices = tuple(Choice(weight, 1.0) for weight in (None, 10.0, 100.0, 1000.0))
    problem: Any = None
    polished = Polished(problem, next(c for c in choices if c.weight == chosen), choices, None)
    assert polished.at_an_end == end
    found: Any = SimpleNamespace(polished=polished, settings=TrainingSettings())
    told = penalty_at_an_end(found)
    assert (end in told) if end else not told
    assert ("penalty=1)" in told) == (end == "least")
    assert ("penalty=100)" in told) == (end == "largest")
