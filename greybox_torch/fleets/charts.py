"""A machine's parameters over the dates of its recordings, as charts of the page."""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import UTC, datetime
from itertools import pairwise

import numpy as np

from greybox_torch.fleets.history import History, Series
from greybox_torch.report import text
from greybox_torch.report.chart.marks import HEIGHT, WIDTH, Mark
from greybox_torch.report.chart.panel import Chart, Panel, side_by_side
from greybox_torch.report.chart.scale import Scale, Tick, linear

MONTHS_FROM, HOURS_BELOW = 150.0, 3.0
"""Days of an axis above which months are enough to mark it, and below which hours are needed."""
MOST_PANELS = 3


@dataclass(frozen=True)
class Dates(Scale):
    """An axis of days since 1970-01-01."""

    def ticks(self, most: int = 6) -> tuple[Tick, ...]:
        """Few enough for the labels to stand side by side on a phone: months over a long time, days and hours over a short one."""
        span = self.high - self.low
        form = "%Y-%m" if span > MONTHS_FROM else "%Y-%m-%d" if span > HOURS_BELOW else "%m-%d %H:%M"
        shares = (1 / 6, 1 / 2, 5 / 6) if span > MONTHS_FROM else (1 / 4, 3 / 4)
        whole = self.low + span * np.array(shares)
        dates = [datetime.fromtimestamp(86400.0 * day, UTC) for day in whole]
        places = self.place(whole)
        return tuple(Tick(float(p), date.strftime(form)) for p, date in zip(places, dates, strict=True))


def history_chart(history: History) -> Chart:
    """What changed; where nothing did, the key parameter, or the first one that was estimated. At most :data:`MOST_PANELS` side by side."""
    changed = [s for s in history.series if s.changes]
    shown = changed or [s for s in history.series if s.key] or list(history.series)[:1]
    caption = "Bars: two standard deviations, where they are known. Dashed: a change, and the mean before and after it."
    return side_by_side([_panel(s) for s in shown[:MOST_PANELS]], caption if changed else caption.split(" Dashed")[0])


def change_sentences(history: History) -> list[str]:
    """Every change in words."""
    return [_sentence(series, k) for series in history.series for k in range(len(series.changes))]


def _sentence(series: Series, k: int) -> str:
    change = series.changes[k]
    when = f"between {series.dates[change.index - 1]} and {series.dates[change.index]}"
    chance = f"chance would do so with a probability of at most {text.number(change.p, 2)}"
    if series.presence:
        what = "appears" if change.after > change.before else "disappears"
        return f"{_title(series)} {what} {when}; {chance}."
    before, after = (text.with_unit(text.number(value), series.unit) for value in (change.before, change.after))
    return f"{_title(series)} goes from {before} to {after} {when}; {chance}."


def _title(series: Series) -> str:
    """Such as `Coulomb friction at rotor: F c` or `J`."""
    parts = series.name.split(".")
    if len(parts) < 2:
        return text.words(series.name)
    effect = f"{text.mechanism(parts[1])} at {text.words(parts[0])}"
    return effect if len(parts) == 2 else f"{effect}: {parts[2]}"


def _panel(series: Series) -> Panel:
    spread = np.nan_to_num(2.0 * series.deviations)
    span = float(np.ptp(series.days))
    room = 0.05 * span or HOURS_BELOW  # about one date: days, as hours would tell no year
    x = Dates(float(series.days[0]) - room, float(series.days[-1]) + room)
    y = Scale(-0.15, 1.15) if series.presence else linear(series.values - spread, series.values + spread, room=0.12)
    label = "" if series.presence else text.with_unit(series.name.rpartition(".")[2], f"[{series.unit or '1'}]")
    alt = f"{_title(series)} over {len(series.values)} recordings from {series.dates[0]} to {series.dates[-1]}"
    marks = (*_changes(series, x, y), *_points(series, x, y))
    panel = Panel(x, y, "", label or "1 where it was found, 0 where not", marks, alt, "low", _title(series))
    return replace(panel, zero=not series.presence)


def _points(series: Series, x: Scale, y: Scale) -> tuple[Mark, ...]:
    across, up = WIDTH * x.place(series.days), HEIGHT * (1.0 - y.place(series.values))
    half = HEIGHT * 2.0 * series.deviations / (y.high - y.low)
    bars = "".join(
        f"M{a:.0f} {b - h:.0f}V{b + h:.0f}" for a, b, h in zip(across, up, half, strict=True) if np.isfinite(b + h)
    )
    dots = "".join(f"M{a:.0f} {b:.0f}h0" for a, b in zip(across, up, strict=True) if np.isfinite(b))
    return Mark("line", "measured thin", bars), Mark("dots", "after", dots)


def _changes(series: Series, x: Scale, y: Scale) -> tuple[Mark, ...]:
    """A dashed line half-way between the recordings about each change, and the mean of each stretch."""
    marks, bounds = [], [0, *(change.index for change in series.changes), len(series.values)]
    if len(bounds) == 2:
        return ()
    edges = [x.low, *(float(series.days[i - 1] + series.days[i]) / 2.0 for i in bounds[1:-1]), x.high]
    places = WIDTH * x.place(np.array(edges))
    for k, (begin, end) in enumerate(pairwise(bounds)):
        level = HEIGHT * (1.0 - float(y.place(series.values[begin:end].mean())))
        marks.append(Mark("line", "before", f"M{places[k]:.0f} {level:.0f}H{places[k + 1]:.0f}"))
    for place in places[1:-1]:
        marks.append(Mark("line", "before dashed", f"M{place:.0f} 0V{HEIGHT}"))
    return tuple(marks)
