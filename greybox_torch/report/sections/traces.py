"""Measured against simulated, before and after, in the validation experiments."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.diagnosis.verdict import Trace, Verdict
from greybox_torch.estimate.metrics import root_mean_square
from greybox_torch.report import text
from greybox_torch.report.chart.marks import Mark, line, span
from greybox_torch.report.chart.panel import Chart, Key, Panel
from greybox_torch.report.chart.scale import Scale, linear

MOST_CHARTS = 12
"""Charts on one page; with more experiments, those whose error was largest are drawn."""

DETAIL = 0.05
"""Share of the record that the detail shows."""


@dataclass(frozen=True)
class Named:
    """A chart under its experiment's name."""

    title: str
    chart: Chart


@dataclass(frozen=True)
class Traces:
    """``left_out`` counts the experiments that are not drawn."""

    charts: tuple[Named, ...]
    left_out: int
    template: str = "traces.html.j2"

    @classmethod
    def of(cls, verdict: Verdict) -> Traces | None:
        shown = validation_traces(verdict)
        if not shown:
            return None
        worst = sorted(shown, key=lambda t: -_relative_error(t))[:MOST_CHARTS]
        several = len({t.output for t in shown}) > 1
        charts = [
            Named(t.experiment + (f": {text.words(t.output)}" if several else ""), _chart(t, bool(verdict.effects)))
            for t in shown
            if any(t is w for w in worst)
        ]
        return cls(tuple(charts), len(shown) - len(charts))


def validation_traces(verdict: Verdict) -> list[Trace]:
    """The traces of validation experiments, where there are any; all of them otherwise."""
    return [t for t in verdict.traces if t.role == "validation"] or list(verdict.traces)


def series(trace: Trace, mismatch: bool) -> dict[str, np.ndarray]:
    """What is drawn beside the measurement: the model before and after effects were attached, or the one that there is."""
    return {"before": trace.refit, "after": trace.augmented} if mismatch else {"model": trace.refit}


def keys(mismatch: bool) -> tuple[Key, ...]:
    """The legend's entries for :func:`series`."""
    if not mismatch:
        return (Key("model", "the model, re-estimated"),)
    return Key("before", "before: the model re-estimated as it was"), Key("after", "after: with the effects attached")


def _relative_error(trace: Trace) -> float:
    size = float(np.nanstd(trace.measured)) or 1.0
    error = root_mean_square(trace.measured, trace.refit) / size
    return error if np.isfinite(error) else np.inf


def _chart(trace: Trace, mismatch: bool) -> Chart:
    whole, detail = slice(None), _worst(trace)
    runs = series(trace, mismatch)
    columns = []
    for part, title in ((whole, "whole record"), (detail, "detail where the error was largest")):
        x = linear(trace.time[part], room=0.0)
        shade = (
            (span(x, float(trace.time[detail][0]), float(trace.time[detail][-1]), "detail"),) if part is whole else ()
        )
        columns.append((_signal(trace, runs, part, x, title, shade), _error(trace, runs, part, x, shade)))
    what = text.first_capital(text.words(trace.output))
    caption = f"{what} measured and simulated, and the error between them: {_told(trace, runs, whole)}."
    return Chart(tuple(columns), caption, (Key("measured", "measured"), *keys(mismatch)))


def _signal(
    trace: Trace, runs: dict[str, np.ndarray], part: slice, x: Scale, title: str, shade: tuple[Mark, ...]
) -> Panel:
    time, (low, high) = trace.time[part], _extent(trace)
    reach = high - low
    y = linear(trace.measured[part], *(np.clip(v[part], low - 0.3 * reach, high + 0.3 * reach) for v in runs.values()))
    marks = [line(x, y, time, trace.measured[part], "measured")]
    marks += [line(x, y, time, values[part], name) for name, values in runs.items()]
    alt = f"{trace.experiment}, {title}: {text.words(trace.output)} measured and simulated over time."
    return Panel(x, y, "", text.axis(trace.output, trace.unit), (*shade, *marks), alt, "tall", title)


def _error(trace: Trace, runs: dict[str, np.ndarray], part: slice, x: Scale, shade: tuple[Mark, ...]) -> Panel:
    time, (low, high) = trace.time[part], _extent(trace)
    reach = 1.2 * (high - low)
    pieces = {name: trace.measured[part] - values[part] for name, values in runs.items()}
    y = linear(*(np.clip(error, -reach, reach) for error in pieces.values()), np.zeros(1))
    marks = [line(x, y, time, error, name) for name, error in pieces.items()]
    alt = f"{trace.experiment}: error over time, {_told(trace, runs, part)}."
    return Panel(x, y, "time [s]", text.axis("error", trace.unit), (*shade, *marks), alt, "medium", zero=True)


def _told(trace: Trace, runs: dict[str, np.ndarray], part: slice) -> str:
    """The size of the errors in words."""
    sizes = []
    for name, values in runs.items():
        size = root_mean_square(trace.measured[part], values[part])
        told = text.with_unit(text.number(size), trace.unit) if np.isfinite(size) else "overflow"
        sizes.append(told if name == "model" else f"{told} {name}")
    return f"root mean square {', '.join(sizes)}"


def _extent(trace: Trace) -> tuple[float, float]:
    """The measurement's range: where a simulation runs away from it, axes do not follow."""
    return float(np.nanmin(trace.measured)), float(np.nanmax(trace.measured))


def _worst(trace: Trace) -> slice:
    """The stretch with the largest error before, at least forty samples long."""
    size = min(len(trace.time), max(40, round(DETAIL * len(trace.time))))
    error = np.nan_to_num(trace.measured - trace.refit, posinf=1e100, neginf=-1e100).clip(-1e100, 1e100) ** 2
    total = np.cumsum(np.concatenate([[0.0], error]))
    begin = int(np.argmax(total[size:] - total[:-size])) if len(error) > size else 0
    return slice(begin, begin + size)
