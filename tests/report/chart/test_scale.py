from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from greybox_torch.report.chart.scale import Scale, degrees, linear, logarithmic


@pytest.mark.parametrize(
    ("scale", "most", "labels"),
    [
        (Scale(0.0, 10.0), 6, ["0", "2", "4", "6", "8", "10"]),
        (Scale(-0.13, 0.13), 6, ["−0.10", "−0.05", "0.00", "0.05", "0.10"]),
        (Scale(1.04, 1.26), 6, ["1.05", "1.10", "1.15", "1.20", "1.25"]),
        (Scale(0.0, 4.1e-6), 4, ["0", "1×10⁻⁶", "2×10⁻⁶", "3×10⁻⁶", "4×10⁻⁶"]),
        (Scale(0.0, 3.2e6), 4, ["0", "1×10⁶", "2×10⁶", "3×10⁶"]),
        (Scale(1.0, 1000.0, logarithmic=True), 6, ["1", "10", "100", "1000"]),
        (Scale(3e-9, 0.2, logarithmic=True), 4, ["10⁻⁸", "10⁻⁶", "10⁻⁴", "0.01"]),
        (Scale(3.0, 70.0, logarithmic=True), 6, ["5", "10", "20", "50"]),
    ],
)
def test_marks_at_round_values(scale: Scale, most: int, labels: list[str]) -> None:
    assert [tick.label for tick in scale.ticks(most)] == labels


@given(st.floats(-1e6, 1e6), st.floats(1e-6, 1e6), st.integers(3, 8))
@example(879609.9999999999, 1e-6, 5)
def test_marks_lie_on_the_axis_and_are_few(low: float, length: float, most: int) -> None:
    ticks = Scale(low, low + length).ticks(most)
    assert 1 <= len(ticks) <= most + 1
    assert all(-1e-6 <= tick.place <= 1 + 1e-6 for tick in ticks)
    assert len({tick.label for tick in ticks}) == len(ticks) or length < 1e-3 * abs(low)


@given(st.floats(-8, 8), st.floats(0.2, 12))
def test_marks_of_a_logarithmic_axis(power: float, decades: float) -> None:
    ticks = Scale(10.0**power, 10.0 ** (power + decades), logarithmic=True).ticks(5)
    assert all(-1e-6 <= tick.place <= 1 + 1e-6 for tick in ticks)
    assert len(ticks) <= 10


def test_axis_over_values() -> None:
    scale = linear(np.array([np.nan, 2.0, 12.0]), np.array([np.inf, 7.0]), room=0.1)
    assert (scale.low, scale.high) == (1.0, 13.0)
    np.testing.assert_allclose(scale.place(np.array([1.0, 7.0, 13.0])), [0.0, 0.5, 1.0])
    assert linear(np.array([3.0, 4.0]), zero=True).low == 0.0
    same = linear(np.array([5.0, 5.0]))
    assert same.low < 5.0 < same.high
    nothing = linear(np.array([np.nan]))
    assert nothing.low < nothing.high


def test_logarithmic_axis_over_values() -> None:
    scale = logarithmic(np.array([0.0, 1e-30, 0.1, 1000.0]), most_decades=6)
    assert scale.low == pytest.approx(1e-3 / 1.3)
    assert scale.high == pytest.approx(1300.0)
    assert scale.place(np.array([0.0]))[0] == -np.inf
    assert logarithmic(np.zeros(3)).low > 0


def test_angles_are_marked_at_parts_of_a_turn() -> None:
    assert [t.label for t in degrees(np.array([-170.0, 0.0])).ticks(4)] == ["−180", "−135", "−90", "−45", "0"]
    assert [t.label for t in degrees(np.array([-1.0, 1.0])).ticks(4)] == ["−1.0", "−0.5", "0.0", "0.5", "1.0"]
    assert [t.label for t in degrees(np.array([0.0, 5000.0])).ticks(4)] == ["0", "1440", "2880", "4320"]
