"""The page's charts on a sheet: the same marks, axes and words, drawn by matplotlib."""

from __future__ import annotations

import re

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from greybox_torch.report.chart.marks import HEIGHT, WIDTH, Mark
from greybox_torch.report.chart.panel import Chart, Key, Panel
from greybox_torch.report.pdf.sheets import INK, MARGIN, QUIET, ROOM, RULE, SPACING, Sheets, broken, wide

COLOURS = {
    "measured": "#8b939c",
    "output": "#8b939c",
    "before": "#c2500a",
    "free": "#c2500a",
    "after": "#0868b0",
    "model": "#0868b0",
    "effect": "#0868b0",
    "beyond": "#0868b0",
    "named": "#0868b0",
    "law": "#0868b0",
    "detail": "#1c2127",
    "data": "#5a636e",
    "seen": "#5a636e",
    "dots": "#5a636e",
}
"""By series; the others are in ink."""

THICK = {"measured": 2.6, "effect": 1.6, "output": 1.1, "free": 1.6, "named": 1.1}
DASHED = ("beyond", "named")
FAINT = {"detail": 0.06, "measured": 0.35}
TALL = {"tall": 120.0, "medium": 80.0, "low": 58.0}
"""Heights of the plots."""

SMALL, LABEL, BETWEEN, TICKS = 7.5, 12.0, 20.0, 34.0


def height_of(chart: Chart, scale: float = 1.0) -> float:
    """About what a chart takes on a sheet, or its first row where it has several."""
    rows = -(-len(chart.columns) // 2)
    caption = len(broken(chart.caption, ROOM, 8.0)) if rows == 1 else 0
    return (
        max(sum(_height(p, scale) for p in c) for c in chart.columns[:2]) + LABEL * 2 + SPACING * 8.0 * caption + 16.0
    )


def draw_chart(sheets: Sheets, chart: Chart, scale: float = 1.0) -> None:
    """A chart with its legend and caption, two columns beside each other; what does not fit goes on the next sheet, row by row.

    Args:
        scale: of the heights of its plots.
    """
    rows = [chart.columns[k : k + 2] for k in range(0, len(chart.columns), 2)]
    for k, row in enumerate(rows):
        legend = _legend_lines(chart.legend) if k == 0 and chart.legend else []
        caption = broken(chart.caption, ROOM, 8.0) if k == len(rows) - 1 else []
        height = max(sum(_height(panel, scale) for panel in column) for column in row)
        sheets.need(height + LABEL * len(legend) + SPACING * 8.0 * len(caption) + 8.0)
        _draw_legend(sheets, legend)
        width = (ROOM - BETWEEN) / 2.0 if len(chart.columns) > 1 else ROOM
        for place, column in enumerate(row):
            top = sheets.top
            for panel in column:
                _draw_panel(sheets, panel, MARGIN + place * (width + BETWEEN), top, width, scale)
                top += _height(panel, scale)
        sheets.top += height
    sheets.text(chart.caption, 8.0, colour=QUIET)
    sheets.gap(8.0)


def _height(panel: Panel, scale: float) -> float:
    """Of a panel with what is written around it."""
    return scale * TALL[panel.size] + LABEL * (2 + bool(panel.title) + bool(panel.x_label)) + 6.0


def _draw_panel(sheets: Sheets, panel: Panel, x: float, top: float, width: float, scale: float) -> None:
    if panel.title:
        sheets.write(_fitting(panel.title, width, 8.0), x, top, 8.0, bold=True)
        top += LABEL
    sheets.write(_fitting(panel.y_label, width, SMALL), x, top, SMALL, colour=QUIET)
    top += LABEL
    height = scale * TALL[panel.size]
    axes = sheets.axes(x + TICKS, top, width - TICKS, height)
    _frame(axes, panel)
    for mark in panel.marks:
        _draw_mark(axes, mark)
    for tick in panel.x_ticks:
        at = x + TICKS + tick.place * (width - TICKS)
        sheets.write(tick.label, at, top + height + 2.0, SMALL, colour=QUIET, align="center")
    for tick in panel.y_ticks:
        at = top + height * (1.0 - tick.place) - 0.55 * SMALL
        sheets.write(tick.label, x + TICKS - 3.0, at, SMALL, colour=QUIET, align="right")
    if panel.x_label:
        sheets.write(panel.x_label, x + width, top + height + LABEL, SMALL, colour=QUIET, align="right")


def _frame(axes: Axes, panel: Panel) -> None:
    axes.set_xlim(0.0, WIDTH)
    axes.set_ylim(HEIGHT, 0.0)
    axes.set_xticks([WIDTH * t.place for t in panel.x_ticks], labels=[])
    axes.set_yticks([HEIGHT * (1.0 - t.place) for t in panel.y_ticks], labels=[])
    axes.tick_params(length=0)
    axes.grid(True, color="#e9ecef", linewidth=0.6)
    axes.set_axisbelow(True)
    for side, spine in axes.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(RULE)
    if panel.zero_line is not None:
        axes.axhline(HEIGHT * (1.0 - panel.zero_line), color=QUIET, linewidth=0.6)


def _draw_mark(axes: Axes, mark: Mark) -> None:
    colour = COLOURS.get(mark.series, INK)
    if not mark.path:
        return
    if mark.kind == "points":
        places = np.array(re.findall(r"M(-?\d+) (-?\d+)", mark.path), dtype=float)
        axes.plot(places[:, 0], places[:, 1], ".", color=colour, markersize=3.6, alpha=0.8)
        return
    path = svg_path(mark.path)
    if mark.kind == "line":
        thick = THICK.get(mark.series, 0.9)
        shade = "#c3c9cf" if mark.series == "measured" else colour
        style = "--" if mark.series in DASHED else "-"
        _put(axes, PathPatch(path, fill=False, edgecolor=shade, linewidth=thick, joinstyle="round", linestyle=style))
    else:
        faint = 1.0 if mark.kind == "bars" else FAINT.get(mark.series, 0.18)
        _put(axes, PathPatch(path, facecolor=colour, linewidth=0.0, alpha=faint))


def _put(axes: Axes, patch: PathPatch) -> None:
    """Onto axes whose limits do not follow it."""
    patch.set_transform(axes.transData)
    patch.set_clip_path(axes.patch)
    axes.add_artist(patch)


def svg_path(path: str) -> Path:
    """A path of the page's pictures (moves, lines across and up, closed areas; all absolute)."""
    places: list[tuple[float, float]] = []
    codes: list[np.uint8] = []
    x = y = 0.0
    for command, numbers in re.findall(r"([MLHVZ])([^MLHVZ]*)", path):
        values = [float(v) for v in numbers.split()]
        if command == "Z":
            codes.append(Path.CLOSEPOLY)
        else:
            x = values[0] if command != "V" else x
            y = values[-1] if command != "H" else y
            codes.append(Path.MOVETO if command == "M" else Path.LINETO)
        places.append((x, y))
    return Path(np.array(places), codes)


def _legend_lines(keys: tuple[Key, ...]) -> list[list[Key]]:
    """The entries of a legend, as many to a line as fit."""
    lines: list[list[Key]] = [[]]
    used = 0.0
    for key in keys:
        length = _entry(key)
        if lines[-1] and used + length > ROOM:
            lines.append([])
            used = 0.0
        lines[-1].append(key)
        used += length
    return lines


def _entry(key: Key) -> float:
    return 34.0 + wide(key.label, 8.0)


def _draw_legend(sheets: Sheets, lines: list[list[Key]]) -> None:
    for line in lines:
        x = MARGIN
        for key in line:
            axes = sheets.axes(x, sheets.top, 14.0, 9.0)
            axes.set_axis_off()
            style = "o" if key.series in ("dots", "data") else "--" if key.series in DASHED else "-"
            places = [0.5] if style == "o" else [0.0, 1.0]
            colour, thick = COLOURS.get(key.series, INK), THICK.get(key.series, 1.6)
            axes.plot(places, [0.5] * len(places), style, color=colour, linewidth=thick, markersize=3.0)
            sheets.write(key.label, x + 19.0, sheets.top, 8.0)
            x += _entry(key)
        sheets.top += LABEL
    sheets.top += 4.0 if lines else 0.0


def _fitting(text: str, width: float, size: float) -> str:
    """The text, cut where it is too long for its place."""
    lines = broken(text, width, size)
    return lines[0] if len(lines) == 1 else f"{lines[0]} …"
