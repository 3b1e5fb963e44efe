"""The effect's own law over its signal, and over it what the data say in its place."""

from __future__ import annotations

import numpy as np

from greybox_torch.diagnosis.effect import Curve, Effect
from greybox_torch.diagnosis.factor import Factor
from greybox_torch.report import text
from greybox_torch.report.chart.marks import RUG, Mark, band, line, points, rug
from greybox_torch.report.chart.panel import Chart, Key, Panel, side_by_side
from greybox_torch.report.chart.scale import Scale, linear

LAW, BEYOND, DATA, BAND, SEEN = "effect", "beyond", "data", "free", "seen"
NAMED = "named"
"""A law over a free curve in its place, dashed: where it is right, it lies on the curve and on the data, which show through it."""

HARDLY = 0.05
"""Share of the samples that a bin would have if they were spread evenly, below which it has hardly any."""

HIDDEN = 0.01
"""Share of the figure's height up to which a band is hardly wider than the line within it."""

A_GAP = 5
"""A gap is at least so many bins side by side with hardly any sample: a free curve is a guess there; a shorter stretch its ends hold."""

FEW_AT_END = 0.25
"""Share of the samples of the median bin that has any, below which bins at either end of a curve have hardly any: beyond them nothing
holds it.
"""

_AT_PORT = ("speed", "position", "deflection", "rate", "level", "load", "input", "output")
"""Names that signals have at a port, whatever the model calls them."""


def law_chart(effect: Effect, curve: Curve) -> Chart:
    """The curve of an effect, with the free curve and the points behind it where there are any."""
    x = linear(curve.values, room=0.0)
    y = _height(curve)
    panel = Panel(
        x,
        y,
        text.axis(_over(effect, curve), curve.unit) + _where_held(curve),
        text.axis("effect", curve.force_unit),
        tuple(_marks(effect, curve, x, y)),
        _alt(effect, curve),
        "tall",
        zero=True,
    )
    return side_by_side([panel], _caption(effect, curve), _legend(effect, curve, y))


def _marks(effect: Effect, curve: Curve, x: Scale, y: Scale) -> list[Mark]:
    seen = [] if curve.seen is None else [rug(x, *_ends(curve), curve.seen, SEEN)]
    return [*seen, *_curves(effect, curve, x, y)]


def _curves(effect: Effect, curve: Curve, x: Scale, y: Scale) -> list[Mark]:
    free, law = curve.free, line(x, y, curve.values, curve.force, LAW)
    if free is None:
        drawn = _extrapolated(curve, ~_gaps(curve), x, y) if effect.mechanism == "unknown" else [law]
        spread = [] if curve.spread is None else [_band(x, y, curve.values, curve.force, curve.spread, LAW)]
        return [*spread, *drawn]
    dots = points(x, y, free.at, free.asked, DATA)
    if effect.mechanism == "unknown":
        around = _band(x, y, curve.values, curve.force, free.spread, LAW)
        return [around, *_extrapolated(curve, np.isfinite(free.spread) & ~_gaps(curve), x, y), dots]
    around = _band(x, y, curve.values, free.force, free.spread, BAND)
    named = line(x, y, curve.values, curve.force, NAMED)
    return [around, line(x, y, curve.values, free.force, BAND), dots, named]


def _ends(curve: Curve) -> tuple[float, float]:
    return float(np.min(curve.values)), float(np.max(curve.values))


def _gaps(curve: Curve) -> np.ndarray:
    """Which of the curve's values (n,) lie in a gap: among at least A_GAP bins side by side, each with hardly any sample, or among those
    at either end, however many.
    """
    if curve.seen is None:
        return np.zeros(len(curve.values), dtype=bool)
    few = curve.seen < max(1.0, HARDLY * float(curve.seen.mean()))
    runs = np.split(np.arange(len(few)), np.flatnonzero(np.diff(few)) + 1)
    wide = np.concatenate([np.full(len(run), few[run[0]] and len(run) >= A_GAP) for run in runs])
    wide |= _few_from_the_end(curve.seen) | _few_from_the_end(curve.seen[::-1])[::-1]
    low, high = _ends(curve)
    place = ((curve.values - low) / (high - low) * len(few)).astype(int)
    return wide[np.clip(place, 0, len(few) - 1)]


def _few_from_the_end(seen: np.ndarray) -> np.ndarray:
    """Which bins (b,) stand before the first one that has more than hardly any of the samples ``seen`` (b,)."""
    usual = float(np.median(seen[seen > 0])) if (seen > 0).any() else 0.0
    return np.logical_and.accumulate(seen < FEW_AT_END * usual)


def _extrapolated(curve: Curve, known: np.ndarray, x: Scale, y: Scale) -> list[Mark]:
    """The curve where there are data, and from there on where there are none."""
    if known.all():
        return [line(x, y, curve.values, curve.force, LAW)]
    inside = known & np.concatenate([[False], known[:-1]]) & np.concatenate([known[1:], [False]])
    return [
        line(x, y, curve.values, np.where(known, curve.force, np.nan), LAW),
        line(x, y, curve.values, np.where(inside, np.nan, curve.force), BEYOND),
    ]


def _band(x: Scale, y: Scale, values: np.ndarray, force: np.ndarray, spread: np.ndarray, series: str) -> Mark:
    return band(x, y, values, force - 2.0 * spread, force + 2.0 * spread, series)


def _height(curve: Curve) -> Scale:
    """An axis over the law and what the data say; where that is not known well, the axis does not follow."""
    low, high = float(np.nanmin(curve.force)), float(np.nanmax(curve.force))
    reach = (high - low) or abs(high)
    ends = low - reach, high + reach
    pieces = [curve.force, np.zeros(1)]
    if curve.free is not None:
        free = curve.free
        pieces += [np.clip(free.force + k * free.spread, *ends) for k in (-2.0, 2.0)]
        if len(free.asked):
            pieces.append(np.clip(np.quantile(free.asked, [0.02, 0.98]), *ends))
    elif curve.spread is not None:
        pieces += [np.clip(curve.force + 2.0 * k * np.nan_to_num(curve.spread), *ends) for k in (-1.0, 1.0)]
    found = linear(*pieces)
    if curve.seen is None:
        return found
    return Scale(
        found.high - (found.high - found.low) / (1.0 - RUG), found.high
    )  # the bars stand below all that is drawn


def _legend(effect: Effect, curve: Curve, y: Scale) -> tuple[Key, ...]:
    if curve.free is None:
        return ()
    dots = Key(DATA, f"estimates from single windows of {curve.free.samples} samples")
    known = curve.free.spread[np.isfinite(curve.free.spread)]
    hidden = len(known) > 0 and 4.0 * float(np.quantile(known, 0.9)) < HIDDEN * (y.high - y.low)
    narrow = " (hardly wider than the line)" if hidden else ""
    if effect.mechanism == "unknown":
        return Key("law", f"the curve, with two standard deviations on either side{narrow}"), dots
    return Key(NAMED, "the law"), Key(BAND, f"a free curve in its place, ± two standard deviations{narrow}"), dots


def _caption(effect: Effect, curve: Curve) -> str:
    settled = "" if effect.memory is None else ", once all has settled"
    settled += ", as that goes up and down once" if bool((np.diff(curve.values) < 0.0).any()) else ""
    over = f"what it adds at {effect.port} over {text.words(_over(effect, curve))}{settled}{_times(curve)}"
    if curve.free is None:
        spread = "" if curve.spread is None else ", with two standard deviations on either side"
        return f"The effect's own curve{spread}: {over}.{_where_seen(effect, curve)}"
    data = (
        f"Dots are partial residuals: the law plus the constant at {effect.port} that best explains the errors of one window of the "
        "estimation experiments, all other parameters as fitted."
    )
    if effect.mechanism == "unknown":
        return f"The effect's own curve: {over}. Dashed it is extrapolated: there are hardly any data. {data}{_where_seen(effect, curve)}"
    return (
        f"The law, and a free curve estimated in its place: {over}. The free curve is drawn only where there are data. {data}"
        f"{_where_seen(effect, curve)}"
    )


def _where_seen(effect: Effect, curve: Curve) -> str:
    if curve.seen is None:
        return ""
    guessed = effect.mechanism == "unknown" and curve.free is None and bool(_gaps(curve).any())
    guess = "; where the curve is dashed hardly any does, and it is a guess" if guessed else ""
    return f" The bars along the foot show where the samples lie{guess}."


def _over(effect: Effect, curve: Curve) -> str:
    """The model's own name of the curve's signal: an effect of the port's position is one of the state `angle`."""
    its_own = effect.signals and curve.signal in _AT_PORT and curve.signal not in effect.signals
    return effect.signals[0] if its_own else curve.signal


def _times(curve: Curve) -> str:
    """What multiplies the curve, as a clause; "" where nothing does."""
    if curve.factor is None:
        return ""
    size = "its root mean square" if curve.factor.value >= 0 else "minus its root mean square"
    return f", in proportion to {text.words(curve.factor.signal)}: drawn where that is {_value(curve.factor)}, {size}"


def _where_held(curve: Curve) -> str:
    """Where what multiplies the curve is held in the figure, as a clause."""
    return "" if curve.factor is None else f", where {text.words(curve.factor.signal)} = {_value(curve.factor)}"


def _value(factor: Factor) -> str:
    return text.with_unit(text.number(factor.value), factor.unit)


def _alt(effect: Effect, curve: Curve) -> str:
    low, high = float(np.nanmin(curve.force)), float(np.nanmax(curve.force))
    with_data = "" if curve.free is None else ", with what the data say"
    ends = [text.with_unit(text.number(end), curve.force_unit) for end in (low, high)]
    return f"Curve of the effect over {text.words(_over(effect, curve))}{_where_held(curve)}: between {' and '.join(ends)}{with_data}."
