"""The figure of a designed recording shows curves that lie on each other, and says from what differences are."""

from __future__ import annotations

import numpy as np

from greybox_torch.report.design import plot_design

TIME = np.linspace(0.0, 1.0, 50)


def test_curves_on_each_other_are_drawn_in_turn() -> None:
    """Seen: five hypotheses, one colour: each lay wholly under the next; and "difference", without from what."""
    same = {name: np.sin(TIME) for name in ("constant bias", "Coulomb friction", "input bias")}
    figure = plot_design("made", TIME, {"u": TIME}, {"speed": same}, {"speed": "rad/s"}, {"speed": 0.1})
    _, outputs, differences = figure.axes
    strokes = [line for line in outputs.lines if line.get_linestyle() == "--"]
    assert len(strokes) == len(same) and len({line.get_color() for line in strokes}) == len(same)
    assert len({line._dash_pattern[0] for line in strokes}) == len(same)  # type: ignore[attr-defined]
    assert differences.get_title(loc="left") == "difference from constant bias"
    two = {"one": np.sin(TIME), "other": np.cos(TIME)}
    (_, _, alone) = plot_design("made", TIME, {"u": TIME}, {"speed": two}, {}, {"speed": 0.1}).axes
    assert [line.get_linestyle() for line in alone.lines] == ["-"]
