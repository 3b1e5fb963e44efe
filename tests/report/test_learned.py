"""The figure of what a network has learned does not say of a law that lies elsewhere that it explains everything."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.report.learned import offset_of
from greybox_torch.training.learned_force import SignalCurve

LEVEL = np.linspace(40.0, 140.0, 30)


def curve(force: np.ndarray) -> SignalCurve:
    return SignalCurve("level", "degC", LEVEL, force, np.ones(30), 1.0)


def test_a_law_is_drawn_with_the_constant_that_the_physics_takes_over() -> None:
    """Seen: "explains 100 % of its variance" above a law 8 to 12 W beside the learned curve, outside of its band."""
    values = np.linspace(40.0, 140.0, 300)
    law = np.interp(values, [40.0, 90.0, 140.0], [0.0, 0.0, -20.0])
    learned = np.interp(LEVEL, values, law)
    assert offset_of(curve(learned + 8.0), values, law) == pytest.approx(8.0)
    assert offset_of(curve(learned + 0.1), values, law) == 0.0
