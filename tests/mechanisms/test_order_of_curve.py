"""The order of a ripple, from a curve over position."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from greybox_torch.mechanisms.matching import matching_laws
from greybox_torch.mechanisms.order_of_curve import order_of_curve
from greybox_torch.mechanisms.torque_ripple import TorqueRipple

POSITION = np.linspace(-1.5, 2.0, 400)


@settings(max_examples=40, deadline=None)
@given(
    periods=st.floats(1.5, 12.0), phase=st.floats(0.0, 6.28), offset=st.floats(-3.0, 3.0), slope=st.floats(-3.0, 3.0)
)
def test_is_found_beside_what_the_model_took_up(periods: float, phase: float, offset: float, slope: float) -> None:
    order = 2.0 * np.pi * periods / (POSITION[-1] - POSITION[0])
    force = 0.2 * np.cos(order * POSITION + phase) + offset + slope * POSITION
    found = order_of_curve(POSITION, force, np.ones_like(POSITION))
    assert (
        found is not None and abs(found / order - 1.0) < 0.1
    )  # as fine as a refit needs, which has 0.8 to 1.25 times it


def test_a_curve_without_range_has_none() -> None:
    assert order_of_curve(np.full(10, 0.3), np.ones(10), np.ones(10)) is None


@pytest.mark.parametrize("order", [3.0, 5.0, 9.0])
def test_a_curve_that_ripples_leads_to_the_ripple(around, order: float) -> None:
    """Seen: a ripple of order 5, drawn by a curve, of which only order 2 was asked: "unknown at the pivot"."""
    force = 0.1 * np.cos(order * POSITION) + 0.02 * np.sin(order * POSITION)
    signals = {"position": torch.as_tensor(POSITION)}
    best = matching_laws("body", around, signals, force, np.ones_like(POSITION))[0]
    assert isinstance(best.law, TorqueRipple) and best.share > 0.95
    assert best.law.order == pytest.approx(order, rel=0.05)
