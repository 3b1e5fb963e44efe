"""Curves, bands and bars as SVG paths."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.report.chart.scale import Scale

WIDTH, HEIGHT = 2000, 1000
"""The picture's own coordinates; the page stretches them."""

RUG = 0.08
"""Share of the picture's height that a rug reaches."""

BINS = 700
"""A curve with more than four samples to a bin is drawn by the extremes in each: what the eye would see, in a fraction of the bytes."""


@dataclass(frozen=True)
class Mark:
    """``kind`` is "line", "area", "points" or "bars"; ``series`` says whose it is and so its colour; ``path`` is SVG."""

    kind: str
    series: str
    path: str


def line(x: Scale, y: Scale, xs: np.ndarray, ys: np.ndarray, series: str, *, held: bool = False) -> Mark:
    """A curve through (xs, ys), in steps where each value is ``held`` until the next; it breaks where a value is not finite."""
    samples = len(xs)
    xs, ys = thinned(xs, np.where(np.isfinite(ys), ys, np.nan))
    if held and len(xs) == samples:  # among extremes of many samples, steps and straight lines look alike
        xs, ys = np.repeat(xs, 2)[1:], np.repeat(ys, 2)[:-1]
    across, up = _pixels(x, y, xs, ys)
    pieces, pen_down = [], False
    for a, b, ok in zip(across, up, np.isfinite(ys) & np.isfinite(xs), strict=True):
        if ok:
            pieces.append(f"{'L' if pen_down else 'M'}{a:.0f} {b:.0f}")
        pen_down = bool(ok)
    return Mark("line", series, "".join(pieces))


def points(x: Scale, y: Scale, xs: np.ndarray, ys: np.ndarray, series: str) -> Mark:
    """A dot at every (xs, ys) that is known and within the axes: lines of no length, whose round ends keep their form on any screen."""
    with np.errstate(invalid="ignore"):
        inside = np.all([(p >= 0.0) & (p <= 1.0) for p in (x.place(xs), y.place(ys))], axis=0)
    across, up = _pixels(x, y, xs[inside], ys[inside])
    return Mark("points", series, "".join(f"M{a:.0f} {b:.0f}h0" for a, b in zip(across, up, strict=True)))


def band(x: Scale, y: Scale, xs: np.ndarray, low: np.ndarray, high: np.ndarray, series: str) -> Mark:
    """The area between two curves; it breaks where either is not finite."""
    known = np.isfinite(low) & np.isfinite(high)
    breaks = np.flatnonzero(np.diff(known.astype(int))) + 1
    pieces = []
    for run in np.split(np.arange(len(xs)), breaks):
        if len(run) and known[run[0]]:
            around = np.concatenate([xs[run], xs[run][::-1]])
            across, up = _pixels(x, y, around, np.concatenate([low[run], high[run][::-1]]))
            pieces.append("M" + "L".join(f"{a:.0f} {b:.0f}" for a, b in zip(across, up, strict=True)) + "Z")
    return Mark("area", series, "".join(pieces))


def span(x: Scale, begin: float, end: float, series: str) -> Mark:
    """A stretch of the horizontal axis, over the whole height."""
    (a, b) = np.round(WIDTH * np.clip(x.place(np.array([begin, end])), 0.0, 1.0))
    return Mark("area", series, f"M{a:.0f} 0H{b:.0f}V{HEIGHT}H{a:.0f}Z")


def bars(x: Scale, y: Scale, edges: np.ndarray, heights: np.ndarray, series: str) -> Mark:
    """Bars from zero, between consecutive edges (n + 1,), of heights (n,)."""
    foot = float(_pixels(x, y, edges[:1], np.zeros(1))[1][0])
    across = WIDTH * np.clip(x.place(edges), 0.0, 1.0)
    tops = _pixels(x, y, edges[:-1], np.nan_to_num(heights))[1]
    gap = 0.06 * float(np.min(np.diff(across))) if len(across) > 1 else 0.0
    boxes = [
        f"M{a + gap:.0f} {foot:.0f}V{top:.0f}H{b - gap:.0f}V{foot:.0f}Z"
        for a, b, top in zip(across[:-1], across[1:], tops, strict=True)
    ]
    return Mark("bars", series, "".join(boxes))


def rug(x: Scale, low: float, high: float, counts: np.ndarray, series: str) -> Mark:
    """Bars on the foot of the picture, from ``low`` to ``high``, as high as the square root of counts (b,): few are seen beside many."""
    across = WIDTH * np.clip(x.place(np.linspace(low, high, len(counts) + 1)), 0.0, 1.0)
    tall = RUG * HEIGHT * np.where(counts > 0, np.maximum(np.sqrt(counts / max(float(counts.max()), 1.0)), 0.2), 0.0)
    boxes = [
        f"M{a:.0f} {HEIGHT}V{HEIGHT - h:.0f}H{b:.0f}V{HEIGHT}Z"
        for a, b, h in zip(across[:-1], across[1:], tall, strict=True)
        if h > 0
    ]
    return Mark("bars", series, "".join(boxes))


def thinned(xs: np.ndarray, ys: np.ndarray, bins: int = BINS) -> tuple[np.ndarray, np.ndarray]:
    """At most two samples a bin, its smallest and its largest in their order; bins without any known sample leave a gap."""
    size = len(ys) // bins
    if size < 4:
        return xs, ys
    count = -(-len(ys) // size)
    padded = np.full(count * size, np.nan)
    padded[: len(ys)] = ys
    boxes = padded.reshape(count, size)
    low = np.argmin(np.where(np.isnan(boxes), np.inf, boxes), axis=1)
    high = np.argmax(np.where(np.isnan(boxes), -np.inf, boxes), axis=1)
    both = np.sort(np.stack([low, high], axis=1), axis=1) + size * np.arange(count)[:, None]
    index = np.minimum(np.unique(both), len(ys) - 1)
    return xs[index], ys[index]


def _pixels(x: Scale, y: Scale, xs: np.ndarray, ys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates of the picture; what lies far outside is held just outside, where it is cut off."""
    across, up = x.place(np.asarray(xs, dtype=float)), y.place(np.asarray(ys, dtype=float))
    return WIDTH * np.clip(across, -1.0, 2.0), HEIGHT * (1.0 - np.clip(up, -1.0, 2.0))
