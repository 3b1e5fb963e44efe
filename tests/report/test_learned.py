"""The figure of what a network has learned does not say of a law that lies elsewhere that it explains everything."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from greybox_torch.report.learned import line_beside, taken_over
from greybox_torch.training.learned_force import SignalCurve

LEVEL = np.linspace(40.0, 140.0, 30)


def curve(force: np.ndarray) -> SignalCurve:
    return SignalCurve("level", "degC", LEVEL, force, np.ones(30), 1.0)


def test_a_law_is_drawn_with_the_constant_that_the_physics_takes_over() -> None:
    """Seen: "explains 100 % of its variance" above a law 8 to 12 W beside the learned curve, outside of its band."""
    values = np.linspace(40.0, 140.0, 300)
    law = np.interp(values, [40.0, 90.0, 140.0], [0.0, 0.0, -20.0])
    learned = np.interp(LEVEL, values, law)
    assert line_beside(curve(learned + 8.0), values, law, False) == (pytest.approx(8.0), 0.0)
    assert line_beside(curve(learned + 0.1), values, law, False) == (0.0, 0.0)


def test_and_with_the_slope_of_a_damping() -> None:
    """Seen: Coulomb friction as a flat line across a learned curve that rises from -1500 to 0 N, and in the table 98 % matched."""
    law = np.full(300, -1500.0)
    values = np.linspace(40.0, 140.0, 300)
    learned = curve(-1500.0 + 15.0 * LEVEL)
    offset, slope = line_beside(learned, values, law, True)
    assert (offset, slope) == (pytest.approx(0.0, abs=1e-6), pytest.approx(15.0))
    assert line_beside(learned, values, law, False)[1] == 0.0


def test_the_figure_says_what_the_physics_takes_over() -> None:
    """Seen: a law at +9.7 and -7.1 N where the network has +5.5 and -4 N, as the damping made up for it."""

    def with_damping(b: float) -> Any:
        declared = [SimpleNamespace(name="b", unit="N s/m"), SimpleNamespace(name="M", unit="kg")]
        return SimpleNamespace(model=SimpleNamespace(declared_parameters=declared), values_by_name={"b": b, "M": 7.0})

    law = SimpleNamespace(mechanism=SimpleNamespace(name="coulomb_friction"))
    term = SimpleNamespace(match=0.9, attachment=law, problem=with_damping(4.0))
    explained: Any = SimpleNamespace(terms=(term,), own=("b", "M"))
    found: Any = SimpleNamespace(result=SimpleNamespace(problem=with_damping(8.2)))
    (line,) = taken_over(found, explained)
    assert line == (
        "beside coulomb_friction is estimated b = 4 N·s/m (beside the network 8.2); what b adds is in neither curve"
    )
    found.result.problem = with_damping(4.05)
    assert taken_over(found, explained) == []
