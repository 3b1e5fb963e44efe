"""Amplitude and phase over frequency, and both relative to the model before, as one chart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.diagnosis.traces import InputTrace, Trace
from greybox_torch.report import text
from greybox_torch.report.chart.marks import Mark, band, line, points
from greybox_torch.report.chart.panel import Chart, Key, Panel
from greybox_torch.report.chart.scale import Scale, degrees, linear, logarithmic

FEEDBACK = (
    " The experiments were recorded under feedback, or their inputs later than they act: the region has room for the most that noise can "
    "bend the estimate, and nothing is drawn beyond the band that is excited from outside."
)

EDGE = 1.02
"""Factor by which the axis goes beyond the first and last frequency, whose dots would be cut in half."""

LEGEND = (
    Key("dots", "measured, with its 95 % region"),
    Key("before", "before: the model re-estimated as it was"),
    Key("after", "after: with the effects attached"),
)


@dataclass(frozen=True)
class Curves:
    """Complex responses (F,) at ``frequency`` (F,) in Hz, and the ``radius`` (F,) of the measured one's 95 % region; NaN where unclear."""

    frequency: np.ndarray
    measured: np.ndarray
    before: np.ndarray
    after: np.ndarray
    radius: np.ndarray

    @property
    def relative(self) -> Curves:
        """Divided by the model before."""
        size = np.abs(self.before)
        return Curves(
            self.frequency,
            _ratio(self.measured, self.before),
            np.ones_like(self.before),
            _ratio(self.after, self.before),
            self.radius / size,
        )


def bode(found: Curves, one: InputTrace, trace: Trace, experiments: int, *, feedback: bool) -> Chart:
    """The chart of one input and one output, estimated from so many experiments; ``feedback``: those were recorded under it."""
    x = Scale(float(found.frequency[0]) / EDGE, float(found.frequency[-1]) * EDGE, logarithmic=True)
    way = f"{text.words(one.input)} to {text.words(trace.output)}"
    columns = []
    for curves, title, axis, shift in (
        (found, f"From {way}", text.axis("amplitude", _unit(one.unit, trace.unit)), "phase [°]"),
        (found.relative, "Relative to the model before", "amplitude ratio", "phase difference [°]"),
    ):
        columns.append((_amplitude(x, curves, title, axis, way), _phase(x, curves, shift, way)))
    several = f"{experiments} experiments" if experiments > 1 else f"the experiment {trace.experiment}"
    caption = (
        f"Frequency response from {way}, from {several}: measured, and by the same estimate from what the models simulate there (local "
        f"polynomial method, Pintelon and Schoukens 2012). {_told(found)} Frequencies at which it is not certain are left out."
        + (FEEDBACK if feedback else "")
    )
    return Chart(tuple(columns), caption, LEGEND)


def _unit(of_input: str, of_output: str) -> str:
    """The unit of a gain; "" where one of the two is not known."""
    if of_input == "1":
        return of_output
    return f"{_factor(of_output)}/{_factor(of_input)}" if of_output and of_input else ""


def _factor(unit: str) -> str:
    """A unit as a part of another one."""
    return unit if unit.isalpha() else f"({unit})"


def _amplitude(x: Scale, curves: Curves, title: str, axis: str, way: str) -> Panel:
    sizes = {name: np.abs(getattr(curves, name)) for name in ("measured", "before", "after")}
    low, high = sizes["measured"] - curves.radius, sizes["measured"] + curves.radius
    reach = np.concatenate(list(sizes.values()))
    relative = title.startswith("Relative")
    y = linear(reach, np.clip(low, 0.0, None), high) if relative else logarithmic(reach, low, high)
    marks = [band(x, y, curves.frequency, low, high, "measured")]
    marks += [line(x, y, curves.frequency, sizes[name], name) for name in ("before", "after")]
    marks.append(points(x, y, curves.frequency, sizes["measured"], "measured"))
    alt = f"{title}: amplitude over frequency of the response from {way}, measured, before and after."
    return Panel(x, y, "", axis, tuple(marks), alt, "medium", title)


def _phase(x: Scale, curves: Curves, axis: str, way: str) -> Panel:
    measured = _unwrapped(np.angle(curves.measured))
    shown = {"measured": measured}
    for name in ("before", "after"):
        shown[name] = measured + np.angle(_ratio(getattr(curves, name), curves.measured))
    spread = np.arcsin(np.clip(curves.radius / np.abs(curves.measured), 0.0, 1.0))
    in_degrees = {name: np.degrees(values) for name, values in shown.items()}
    low, high = np.degrees(measured - spread), np.degrees(measured + spread)
    y = degrees(*in_degrees.values(), low, high)
    marks: list[Mark] = [band(x, y, curves.frequency, low, high, "measured")]
    marks += [line(x, y, curves.frequency, in_degrees[name], name) for name in ("before", "after")]
    marks.append(points(x, y, curves.frequency, in_degrees["measured"], "measured"))
    alt = f"{axis} over frequency of the response from {way}, measured, before and after."
    return Panel(x, y, "frequency [Hz]", axis, tuple(marks), alt, "medium")


def _ratio(above: np.ndarray, below: np.ndarray) -> np.ndarray:
    with np.errstate(invalid="ignore"):  # of unclear ones
        return above / below


def _unwrapped(phase: np.ndarray) -> np.ndarray:
    """Phase in rad without jumps, across gaps as well."""
    known = np.isfinite(phase)
    result = np.full(len(phase), np.nan)
    result[known] = np.unwrap(phase[known])
    return result


def _told(found: Curves) -> str:
    """How far the models are from the measurement, in words: the mean relative distance in the complex plane."""
    size = np.abs(found.measured)
    before, after = (float(np.nanmean(np.abs(g - found.measured) / size)) for g in (found.before, found.after))
    least = float(np.nanmean(found.radius / size))
    return (
        f"Their mean distance from it is {text.percent(before)} of its amplitude before and {text.percent(after)} after; the radius of its "
        f"95 % region is {text.percent(least)}."
    )
