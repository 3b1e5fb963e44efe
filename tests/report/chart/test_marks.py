from __future__ import annotations

import re

import numpy as np

from greybox_torch.report.chart.marks import BINS, band, bars, line, points, rug, span, thinned
from greybox_torch.report.chart.scale import Scale

X, Y = Scale(0.0, 10.0), Scale(0.0, 1.0)


def test_line() -> None:
    mark = line(X, Y, np.array([0.0, 5.0, 10.0]), np.array([0.0, 1.0, 0.5]), "before")
    assert (mark.kind, mark.series) == ("line", "before")
    assert mark.path == "M0 1000L1000 0L2000 500"


def test_values_that_are_held_are_steps() -> None:
    mark = line(X, Y, np.array([0.0, 5.0, 10.0]), np.array([0.0, 1.0, 0.5]), "input", held=True)
    assert mark.path == "M0 1000L1000 1000L1000 0L2000 0L2000 500"
    gap = line(X, Y, np.array([0.0, 5.0, 10.0]), np.array([1.0, np.nan, 1.0]), "input", held=True)
    assert gap.path == "M0 0L1000 0M2000 0"


def test_a_line_breaks_where_values_are_missing() -> None:
    values = np.array([0.0, np.nan, 1.0, np.inf, 1.0])
    assert line(X, Y, np.array([0.0, 1.0, 2.0, 3.0, 4.0]), values, "").path == "M0 1000M400 0M800 0"


def test_what_lies_far_outside_is_held_just_outside() -> None:
    path = line(X, Y, np.array([0.0, 10.0]), np.array([1e200, -1e200]), "").path
    assert path == "M0 -1000L2000 2000"


def test_a_long_record_keeps_its_extremes_and_gaps() -> None:
    time = np.linspace(0.0, 10.0, 100_000)
    values = 0.5 + 0.1 * np.sin(300 * time)
    values[54_321] = 0.99
    values[12_345] = 0.01
    values[70_000:80_000] = np.nan
    few_x, few_y = thinned(time, values)
    assert len(few_x) <= 2 * BINS + 2
    assert (np.diff(few_x) > 0).all()
    assert np.nanmax(few_y) == 0.99
    assert np.nanmin(few_y) == 0.01
    assert np.isnan(few_y[(few_x > 7.1) & (few_x < 7.9)]).all()
    path = line(X, Y, time, values, "").path
    assert path.count("M") == 2
    assert len(path) < 20_000


def test_short_records_are_left_alone() -> None:
    time, values = np.arange(100.0), np.arange(100.0)
    assert thinned(time, values)[1] is values


def test_band_breaks_where_values_are_missing() -> None:
    xs = np.array([0.0, 2.0, 4.0, 6.0, 8.0])
    low, high = np.array([0.0, 0.1, np.nan, 0.2, 0.2]), np.array([0.5, 0.5, 0.5, 0.7, np.inf])
    path = "M0 1000L400 900L400 500L0 500Z" + "M1200 800L1200 300Z"
    assert band(X, Y, xs, low, high, "effect").path == path


def test_points_within_the_axes() -> None:
    found = points(X, Y, np.array([0.0, 5.0, 11.0, 5.0, 5.0]), np.array([0.0, 0.5, 0.5, 2.0, np.nan]), "measured")
    assert (found.kind, found.path) == ("points", "M0 1000h0M1000 500h0")


def test_span_is_cut_at_the_edges() -> None:
    assert span(X, 5.0, 20.0, "detail").path == "M1000 0H2000V1000H1000Z"


def test_bars_stand_on_zero() -> None:
    path = bars(X, Scale(-1.0, 1.0), np.array([0.0, 5.0, 10.0]), np.array([1.0, -0.5]), "effect").path
    assert re.findall(r"V(-?\d+)", path) == ["0", "500", "750", "500"]


def test_a_rug_stands_on_the_foot_and_few_samples_are_seen_beside_many() -> None:
    mark = rug(X, 0.0, 10.0, np.array([10_000, 0, 1]), "seen")
    assert (mark.kind, mark.path) == ("bars", "M0 1000V920H667V1000ZM1333 1000V984H2000V1000Z")
