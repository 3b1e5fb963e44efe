from __future__ import annotations

import numpy as np
from matplotlib.path import Path

from greybox_torch.report.chart.marks import band, bars, line, span
from greybox_torch.report.chart.scale import Scale
from greybox_torch.report.pdf.charts import svg_path

X, Y = Scale(0.0, 10.0), Scale(0.0, 1.0)


def test_a_line_with_a_gap() -> None:
    path = svg_path(line(X, Y, np.array([0.0, 5.0, 6.0, 10.0]), np.array([0.0, 1.0, np.nan, 0.5]), "").path)
    assert np.asarray(path.vertices).tolist() == [[0.0, 1000.0], [1000.0, 0.0], [2000.0, 500.0]]
    assert np.asarray(path.codes).tolist() == [Path.MOVETO, Path.LINETO, Path.MOVETO]


def test_areas() -> None:
    (area,) = svg_path(span(X, 5.0, 10.0, "").path).to_polygons()
    assert np.unique(area, axis=0).tolist() == [[1000.0, 0.0], [1000.0, 1000.0], [2000.0, 0.0], [2000.0, 1000.0]]
    around = svg_path(band(X, Y, np.array([0.0, 10.0]), np.zeros(2), np.ones(2), "").path)
    assert around.contains_point((1000.0, 500.0))
    two = svg_path(bars(X, Y, np.array([0.0, 5.0, 10.0]), np.array([0.2, 0.6]), "").path)
    assert [two.contains_point((500.0, h)) for h in (900.0, 700.0)] == [True, False]
    assert [two.contains_point((1500.0, h)) for h in (900.0, 700.0, 300.0)] == [True, True, False]
