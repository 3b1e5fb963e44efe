from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.curve import FreeCurve
from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.factor import Factor
from greybox_torch.report.chart.marks import RUG
from greybox_torch.report.chart.panel import Chart
from greybox_torch.report.sections.law import law_chart
from tests.report.conftest import BACKLASH, UNKNOWN


def over_data(effect: Effect) -> Effect:
    """With a free curve at ten above the law that is known in the middle, and three points, one of them far away."""
    assert effect.curve is not None
    known = np.where(np.abs(effect.curve.values) < 0.05, effect.curve.force + 10.0, np.nan)
    free = FreeCurve(known, 0.1 + 0.0 * known, np.array([-0.05, 0.0, 0.05]), np.array([0.1, 0.0, 1e6]), 62)
    return replace(effect, curve=replace(effect.curve, free=free))


def drawn(effect: Effect) -> Chart:
    assert effect.curve is not None
    return law_chart(effect, effect.curve)


def test_a_law_alone() -> None:
    assert BACKLASH.curve is not None
    chart = drawn(replace(BACKLASH, curve=replace(BACKLASH.curve, spread=None)))
    assert [m.kind for m in chart.columns[0][0].marks] == ["line"]
    assert chart.legend == () and "data" not in chart.caption


def test_a_law_over_the_data() -> None:
    chart = drawn(over_data(BACKLASH))
    (panel,) = chart.columns[0]
    assert [(m.kind, m.series) for m in panel.marks] == [
        ("area", "free"),
        ("line", "free"),
        ("points", "data"),
        ("line", "named"),
    ]
    assert "a free curve estimated in its place" in chart.caption and "partial residuals" in chart.caption
    assert "the constant at gear_spring that" in chart.caption  # seen: a "constant force" at a valve, in l/min
    assert [key.series for key in chart.legend] == ["named", "free", "data"]
    assert chart.legend[2].label == "estimates from single windows of 62 samples"


def test_the_axis_does_not_follow_what_is_not_known() -> None:
    """The law reaches from −0.125 to 0.125: what lies farther off than that again is cut."""
    scale = drawn(over_data(BACKLASH)).columns[0][0].y
    assert -0.45 < scale.low < -0.125 and 0.125 < scale.high < 0.45


def test_the_bars_stand_below_what_is_drawn() -> None:
    """Seen: a Coulomb curve on the lower edge, with its dots behind the bars that show where samples lie."""
    assert BACKLASH.curve is not None
    scale = drawn(replace(BACKLASH, curve=replace(BACKLASH.curve, seen=np.full(40, 3)))).columns[0][0].y
    lowest = (float(BACKLASH.curve.force.min()) - scale.low) / (scale.high - scale.low)
    assert lowest > RUG


def test_an_unknown_curve_has_its_band_and_points() -> None:
    chart = drawn(over_data(UNKNOWN))
    assert [(m.kind, m.series) for m in chart.columns[0][0].marks] == [
        ("area", "effect"),
        ("line", "effect"),
        ("line", "beyond"),
        ("points", "data"),
    ]
    solid, dashed = chart.columns[0][0].marks[1:3]
    assert (solid.path.count("M"), dashed.path.count("M")) == (1, 2), "dashed on either side of where the records were"
    assert chart.legend[0].label == "the curve, with two standard deviations on either side"


def test_without_any_point() -> None:
    effect = over_data(BACKLASH)
    assert effect.curve is not None and effect.curve.free is not None
    none = replace(effect.curve.free, at=np.zeros(0), asked=np.zeros(0))
    assert drawn(replace(effect, curve=replace(effect.curve, free=none))).columns[0][0].marks[-2].path == ""


def test_a_signal_has_the_name_of_the_state() -> None:
    """Seen: a ripple drawn over "position", and beneath it where it acts over "angle"."""
    assert BACKLASH.curve is not None
    own = replace(BACKLASH, signals=("angle",), curve=replace(BACKLASH.curve, signal="position"))
    chart = drawn(own)
    assert chart.columns[0][0].x_label.startswith("angle") and "over angle" in chart.caption
    elsewhere = replace(own, curve=replace(BACKLASH.curve, signal="rate of the input"))
    assert drawn(elsewhere).columns[0][0].x_label.startswith("rate of the input")


def over_levels(effect: Effect) -> Effect:
    """With samples at three levels of the signal alone: both ends and the middle."""
    assert effect.curve is not None
    seen = np.zeros(100, dtype=int)
    seen[[0, *range(44, 56), 99]] = 400
    return replace(effect, curve=replace(effect.curve, spread=None, seen=seen))


def test_an_unknown_curve_is_dashed_where_hardly_any_sample_lies() -> None:
    """Seen: a stirrer at five speeds only, and a hump between two of them in one solid line."""
    chart = drawn(over_levels(UNKNOWN))
    foot, solid, dashed = chart.columns[0][0].marks
    assert (foot.kind, foot.series, foot.path.count("M")) == ("bars", "seen", 14)
    assert (solid.series, dashed.series, dashed.path.count("M")) == ("effect", "beyond", 2)
    assert "hardly any does, and it is a guess" in chart.caption


def test_a_law_shows_where_the_samples_lie_and_stays_solid() -> None:
    chart = drawn(over_levels(BACKLASH))
    assert [m.series for m in chart.columns[0][0].marks] == ["seen", "effect"]
    assert chart.caption.endswith("The bars along the foot show where the samples lie.")


def test_a_free_band_does_not_hide_a_gap() -> None:
    effect = over_data(UNKNOWN)
    assert effect.curve is not None
    seen = np.where(np.abs(np.arange(100) - 50) < 10, 0, 30)
    chart = drawn(replace(effect, curve=replace(effect.curve, seen=seen)))
    solid, dashed = chart.columns[0][0].marks[2:4]
    assert (solid.path.count("M"), dashed.path.count("M")) == (2, 3)


def test_a_curve_that_is_multiplied_says_by_what_and_where_it_is_drawn() -> None:
    """Seen: "curve over lining, times chamber - lining", drawn over lining in kW, and that factor nowhere."""
    assert UNKNOWN.curve is not None and UNKNOWN.curve.factor is None
    by = Factor("chamber - lining", "degC", 94.72)
    chart = drawn(replace(UNKNOWN, curve=replace(UNKNOWN.curve, factor=by)))
    assert chart.columns[0][0].x_label == "gear twist [rad], where chamber - lining = 94.7 degC"
    assert "in proportion to chamber - lining: drawn where that is 94.7 degC, its root mean square." in chart.caption
    plain = drawn(UNKNOWN)
    assert plain.columns[0][0].x_label == "gear twist [rad]" and "proportion" not in plain.caption


@pytest.mark.parametrize("effect", [BACKLASH, UNKNOWN])
def test_a_band_behind_its_line_is_told(effect: Effect) -> None:
    """Seen: "± two standard deviations" in the legend, and none in the figure."""
    wide = over_data(effect)
    assert wide.curve is not None and wide.curve.free is not None
    free = replace(wide.curve.free, spread=0.005 * wide.curve.free.spread)
    narrow = replace(wide, curve=replace(wide.curve, free=free))
    told = [next(k.label for k in drawn(one).legend if "deviations" in k.label) for one in (wide, narrow)]
    assert ["hardly wider than the line" in label for label in told] == [False, True]


def test_a_curve_is_dashed_at_its_ends_where_hardly_any_sample_lies() -> None:
    """Seen: a straight line that bent back over the last tenth of its range, with 40 of 4032 samples, drawn as if it were known."""
    assert UNKNOWN.curve is not None
    seen = np.r_[np.full(36, 40), 5, 4, 3, 1]
    curve = replace(UNKNOWN.curve, free=None, spread=None, seen=seen)
    marks = drawn(replace(UNKNOWN, curve=curve)).columns[0][0].marks
    assert [(m.kind, m.series) for m in marks[1:]] == [("line", "effect"), ("line", "beyond")]
    even = drawn(replace(UNKNOWN, curve=replace(curve, seen=np.full(40, 40)))).columns[0][0].marks
    assert [(m.kind, m.series) for m in even[1:]] == [("line", "effect")]
