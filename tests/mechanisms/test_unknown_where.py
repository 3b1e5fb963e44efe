"""Over what free curves are drawn: a part of a range, and nothing that is nowhere twice."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.mechanisms.unknown import Unknown


def test_a_curve_over_a_part_is_zero_elsewhere(law, around) -> None:
    span = around.ranges["speed"]
    low, high = span.low + 0.4 * span.span, span.low + 0.5 * span.span
    local = Unknown("speed", 6, part=(low, high))
    heights = {f"w_{k}": 1.0 for k in range(6)}
    inside = law(local, heights, speed=np.linspace(low, high, 20))
    outside = law(local, heights, speed=np.array([span.low, low - 0.5 * span.span, high + 0.3 * span.span, span.high]))
    assert inside.min() > 0.9 and np.abs(outside).max() < 1e-12
    assert (local.centres(around)[0], local.centres(around)[-1]) == pytest.approx((low, high))
    assert Unknown(**local.options()).part == local.part and Unknown(**Unknown("speed").options()).part is None


@pytest.mark.parametrize(("signal", "offered"), [("position", False), ("speed", True)])
def test_no_curve_over_what_is_nowhere_twice(around, signal, offered) -> None:
    around = replace(around, passed_once=frozenset({"position"}))
    assert Unknown(signal).available(around) is offered
