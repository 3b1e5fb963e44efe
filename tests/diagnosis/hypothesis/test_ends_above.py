"""Which of several fits are followed to their end."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.hypothesis.fit import _apart
from greybox_torch.diagnosis.settings import SearchBudget


@pytest.mark.parametrize(
    ("mean_square", "promise", "value", "followed"),
    [
        (1.2, 1.19, 2.0, False),  # at its optimum, above the best
        (1.2, 0.9, 2.0, True),  # on its way below it
        (1.2, 1.05, 2.0, True),  # too far from its optimum for its model to be believed
        (1.2, 0.9, 1.0, False),  # at the same place as the best
        (5.0, 0.9, 2.0, False),  # far behind
    ],
)
def test_a_rival_is_followed_where_it_may_end_lower(stub: Any, mean_square, promise, value, followed) -> None:
    best = stub(mean_square=1.0, promise=0.99, problem=stub(values=np.array([1.0])))
    rival = stub(mean_square=mean_square, promise=promise, problem=stub(values=np.array([value])))
    assert (rival in _apart([best, rival], SearchBudget())) is followed
