"""What a training prints of the choices that the held-out stretches made."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from greybox_torch.api.train_held_out import mostly_lost
from greybox_torch.api.train_summary import LOST, choice_rows
from greybox_torch.training.polish import Choice


def test_a_baseline_that_ran_away_is_said_to_have() -> None:
    """Seen: "physics alone 74792" beside 0.083, without a word."""
    choices = (Choice(None, 74792.0), Choice(10.0, 0.09), Choice(100.0, float("inf")), Choice(1000.0, 3.0))
    problem = SimpleNamespace(records=SimpleNamespace(y=np.array([[-2.0, 2.0, np.nan]])), weights=np.array([0.5]))
    polished = SimpleNamespace(choices=choices, chosen=choices[1])
    found: Any = SimpleNamespace(result=SimpleNamespace(problem=problem), polished=polished)
    assert [row[2] for row in choice_rows(found)] == [LOST, "chosen", LOST, ""]
    assert not mostly_lost(found)
    polished.choices = (choices[0], choices[1], choices[2], Choice(1000.0, 6000.0))
    assert mostly_lost(found), "seen: nearly all held-out runs ran away, and no plain word of it"
