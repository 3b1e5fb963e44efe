"""Measured against simulated, before and after, in the validation experiments."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np

from greybox_torch.diagnosis.traces import InputTrace, Trace
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.estimate.metrics import root_mean_square
from greybox_torch.name_lists import listed
from greybox_torch.report import text
from greybox_torch.report.chart.marks import Mark, line, span
from greybox_torch.report.chart.panel import Chart, Key, Live, Panel
from greybox_torch.report.chart.samples import Samples, share_of_each
from greybox_torch.report.chart.scale import Scale, linear
from greybox_torch.report.time_axis import TimeUnit, time_unit

MOST_CHARTS = 12
"""Charts on one page; with more experiments, those whose error was largest are drawn."""

MOST_INPUTS = 2
"""Inputs that are drawn beneath an experiment's first output."""

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
        drawn = [t for t in shown if any(t is w for w in worst)]
        several = len({t.output for t in shown}) > 1
        mismatch, numbers = bool(verdict.effects), list(dict.fromkeys(t.experiment for t in drawn))
        inputs = [_inputs(verdict, t) if t is _first(drawn, t.experiment) else () for t in drawn]
        most = share_of_each(len(drawn), 1 + 2 * len(series(drawn[0], mismatch)) + max(map(len, inputs)))
        titles = [t.experiment + (f": {text.words(t.output)}" if several else "") for t in drawn]
        charts = [
            Named(
                title,
                _chart(
                    t,
                    mismatch,
                    own,
                    numbers.index(t.experiment),
                    most,
                    _where_inputs_are(verdict, t, own, drawn, titles),
                ),
            )
            for t, own, title in zip(drawn, inputs, titles, strict=True)
        ]
        return cls(tuple(charts), len(shown) - len(charts))


def _first(traces: Sequence[Trace], experiment: str) -> Trace:
    """The first trace of an experiment, which has its inputs beneath it."""
    return next(t for t in traces if t.experiment == experiment)


def _inputs(verdict: Verdict, trace: Trace) -> tuple[InputTrace, ...]:
    """The first inputs of a trace's experiment."""
    own = (i for i in verdict.inputs if i.experiment == trace.experiment and len(i.time) == len(trace.time))
    return tuple(islice(own, MOST_INPUTS))


def _where_inputs_are(
    verdict: Verdict, trace: Trace, drawn: Sequence[InputTrace], traces: Sequence[Trace], titles: Sequence[str]
) -> str:
    """Which inputs are not ``drawn`` beneath a trace, and where they are, as sentences."""
    first = _first(traces, trace.experiment)
    if trace is not first:
        there = bool(_inputs(verdict, first))
        return (
            f" Inputs are drawn under {next(n for n, t in zip(titles, traces, strict=True) if t is first)}."
            if there
            else ""
        )
    names = [i.input for i in verdict.inputs if i.experiment == trace.experiment][len(drawn) :]
    return f" Not drawn of the inputs: {listed([text.words(name) for name in names])}." if names and drawn else ""


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


@dataclass(frozen=True)
class _Stretch:
    """A part of one output's record, with the axis, in ``unit``, and the shade of its panels; ``closer`` where a reader can look closer."""

    trace: Trace
    runs: dict[str, np.ndarray]
    part: slice
    x: Scale
    shade: tuple[Mark, ...]
    detail: tuple[float, float]
    closer: bool
    unit: TimeUnit

    @property
    def time(self) -> np.ndarray:
        return self.trace.time[self.part]

    @property
    def reach(self) -> float:
        low, high = _extent(self.trace)
        return high - low

    def live(self, names: dict[str, str], low: float, high: float, *, held: bool = False) -> Live | None:
        return Live(names, (low, high), self.detail, held) if self.closer else None


def _chart(
    trace: Trace, mismatch: bool, inputs: Sequence[InputTrace], experiment: int, most: int, of_inputs: str
) -> Chart:
    unit = time_unit(float(np.ptp(trace.time)))
    trace = replace(trace, time=trace.time / unit.seconds)
    runs = series(trace, mismatch)
    worst = _worst(trace, list(runs.values())[-1])
    where = "detail where the error after is largest" if mismatch else "detail where the error is largest"
    detail = float(trace.time[worst][0]), float(trace.time[worst][-1])
    columns = []
    for part, title in ((slice(None), "whole record"), (worst, where)):
        x, closer = linear(trace.time[part], room=0.0), part is not worst
        shade = (span(x, *detail, "detail"),) if closer else ()
        here = _Stretch(trace, runs, part, x, shade, detail, closer, unit)
        last = len(inputs) == 0
        panels = [_signal(here, title), _error(here, last=last)]
        panels += [_input(here, one, k, last=k == len(inputs) - 1) for k, one in enumerate(inputs)]
        columns.append(tuple(panels))
    what = text.title(trace.output)
    caption = (
        f"{what} measured and simulated, and the error between them: {_told(trace, runs, slice(None))}.{of_inputs}"
    )
    samples = Samples(experiment, trace.time, _carried(trace, runs, inputs)).text(most)
    return Chart(tuple(columns), caption, (Key("measured", "measured"), *keys(mismatch)), samples)


def _carried(trace: Trace, runs: dict[str, np.ndarray], inputs: Sequence[InputTrace]) -> dict[str, np.ndarray]:
    """What a reader can look closer at, by name; a simulation that runs away is cut where axes do not follow."""
    low, high = _extent(trace)
    room = 3.0 * (high - low)
    held = {name: np.clip(values, low - room, high + room) for name, values in runs.items()}
    errors = {f"error_{name}": trace.measured - values for name, values in held.items()}
    return {"measured": trace.measured, **held, **errors, **{f"input_{k}": i.values for k, i in enumerate(inputs)}}


def _signal(here: _Stretch, title: str) -> Panel:
    trace, part, (low, high) = here.trace, here.part, _extent(here.trace)
    ends = low - 0.3 * here.reach, high + 0.3 * here.reach
    y = linear(trace.measured[part], *(np.clip(v[part], *ends) for v in here.runs.values()))
    marks = [line(here.x, y, here.time, trace.measured[part], "measured")]
    marks += [line(here.x, y, here.time, values[part], name) for name, values in here.runs.items()]
    alt = f"{trace.experiment}, {title}: {text.words(trace.output)} measured and simulated over time."
    live = here.live({"measured": "measured", **{name: name for name in here.runs}}, *ends)
    return Panel(
        here.x, y, "", text.axis(trace.output, trace.unit), (*here.shade, *marks), alt, "tall", title, live=live
    )


def _error(here: _Stretch, *, last: bool) -> Panel:
    trace, part, reach = here.trace, here.part, 1.2 * here.reach
    pieces = {name: trace.measured[part] - values[part] for name, values in here.runs.items()}
    y = linear(*(np.clip(error, -reach, reach) for error in pieces.values()), np.zeros(1))
    marks = [line(here.x, y, here.time, error, name) for name, error in pieces.items()]
    alt = f"{trace.experiment}: error over time, {_told(trace, here.runs, part)}."
    live = here.live({name: f"error_{name}" for name in here.runs}, -reach, reach)
    label = here.unit.label if last else ""
    axis = text.axis("error", trace.unit)
    return Panel(here.x, y, label, axis, (*here.shade, *marks), alt, "medium", zero=True, live=live)


def _input(here: _Stretch, one: InputTrace, number: int, *, last: bool) -> Panel:
    values = one.values[here.part]
    y = linear(values)
    marks = (*here.shade, line(here.x, y, here.time, values, "input", held=one.held))
    alt = f"{here.trace.experiment}: the input {text.words(one.input)} over time."
    ends = float(np.nanmin(one.values)), float(np.nanmax(one.values))
    live = here.live({"input": f"input_{number}"}, *ends, held=one.held)
    label = here.unit.label if last else ""
    return Panel(here.x, y, label, text.axis(one.input, one.unit), marks, alt, "low", live=live)


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


def _worst(trace: Trace, simulated: np.ndarray) -> slice:
    """The stretch with the largest error of a run (N,), at least forty samples long."""
    size = min(len(trace.time), max(40, round(DETAIL * len(trace.time))))
    error = np.nan_to_num(trace.measured - simulated, posinf=1e100, neginf=-1e100).clip(-1e100, 1e100) ** 2
    total = np.cumsum(np.concatenate([[0.0], error]))
    begin = int(np.argmax(total[size:] - total[:-size])) if len(error) > size else 0
    return slice(begin, begin + size)
