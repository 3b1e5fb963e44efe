"""At which frequencies the error lies, before and after."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.diagnosis.traces import Trace
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.report import text
from greybox_torch.report.chart.marks import line
from greybox_torch.report.chart.panel import Chart, Key, Panel, side_by_side
from greybox_torch.report.chart.scale import Scale, logarithmic
from greybox_torch.report.sections.traces import keys, series, validation_traces

SEGMENT = 8192
"""Longest segment of the averaged periodograms, in samples."""

PER_DECADE = 40
"""Values that a decade of frequency is drawn with."""
MOST_DECADES = 15.0
"""Of power that the axis reaches down: to the steps of a fine encoder, and not to the rounding of a simulation."""
_FEWEST = 8  # samples of a segment that a spectrum is made of


@dataclass(frozen=True)
class Spectra:
    """Power spectral densities (unit²/Hz) at ``frequency`` (Hz) by series: "output" (as measured), and "before" and "after", or "model"."""

    output: str
    unit: str
    frequency: np.ndarray
    density: dict[str, np.ndarray]


@dataclass(frozen=True)
class Spectrum:
    """One chart, with a panel for every output (and sample time, where experiments differ in it)."""

    chart: Chart
    template: str = "spectrum.html.j2"

    @classmethod
    def of(cls, verdict: Verdict) -> Spectrum | None:
        found = spectra(verdict)
        if not found:
            return None
        what = "of the error before and after" if verdict.effects else "of the error that remains"
        caption = f"Power spectral density {what}, and of the measured output for comparison (Welch's method, all validation experiments)."
        errors = (
            Key(key.series, f"error {key.series}" if verdict.effects else "error that remains")
            for key in keys(bool(verdict.effects))
        )
        legend = (Key("output", "measured output"), *errors)
        return cls(side_by_side([_panel(s) for s in found], caption, legend))


def spectra(verdict: Verdict) -> list[Spectra]:
    """Averaged over the validation experiments of an output that share a sample time, but for those too short for a spectrum."""
    groups: dict[tuple[str, float], list[Trace]] = {}
    for trace in validation_traces(verdict):
        if len(trace.time) < _FEWEST:
            continue
        step = float(np.median(np.diff(trace.time)))
        groups.setdefault((trace.output, float(f"{step:.3g}")), []).append(trace)
    return [_averaged(traces, step, bool(verdict.effects)) for (_, step), traces in groups.items()]


def _averaged(traces: list[Trace], step: float, mismatch: bool) -> Spectra:
    segment = min(SEGMENT, max(_FEWEST, min(len(t.time) for t in traces) // 4))
    weights = np.array([len(t.time) for t in traces], dtype=float)
    total: dict[str, np.ndarray] = {}
    frequency = np.zeros(0)
    for trace, weight in zip(traces, weights / weights.sum(), strict=True):
        signals = {"output": trace.measured - np.nanmean(trace.measured)}
        signals |= {name: trace.measured - values for name, values in series(trace, mismatch).items()}
        for name, signal in signals.items():
            frequency, density = _density(signal, step, segment)
            total[name] = total.get(name, 0.0) + weight * density
    inner = slice(1, -1)  # the ends of a one-sided density count half
    frequency = frequency[inner]
    place = np.floor(PER_DECADE * np.log10(frequency / frequency[0]) + 1e-9)
    _, index, count = np.unique(place, return_inverse=True, return_counts=True)
    pooled = {name: np.bincount(index, density[inner]) / count for name, density in total.items()}
    return Spectra(traces[0].output, traces[0].unit, np.bincount(index, frequency) / count, pooled)


def _density(signal: np.ndarray, step: float, segment: int) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies (K,) [Hz] and one-sided power density (K,) of a signal (N,); missing samples are bridged by straight lines, which adds
    no steps.

    Source: P. D. Welch, "The use of fast Fourier transform for the estimation of power spectra", IEEE Transactions on Audio and
    Electroacoustics 15, 1967; the mean over segments that overlap by half, weighed by Hann's window. (As scipy.signal.welch has it, which
    takes a second to import.)
    """
    known = np.flatnonzero(np.isfinite(signal) & (np.abs(signal) < 1e100))
    filled = np.interp(np.arange(len(signal)), known, signal[known]) if known.size else np.zeros(len(signal))
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(segment) / segment)
    pieces = np.lib.stride_tricks.sliding_window_view(filled, segment)[:: segment - segment // 2]
    moving = (pieces - pieces.mean(axis=1, keepdims=True)) * window
    power = (np.abs(np.fft.rfft(moving)) ** 2).mean(axis=0) * step / (window**2).sum()
    power[1 : None if segment % 2 else -1] *= 2.0  # what negative frequencies have
    return np.fft.rfftfreq(segment, step), power


def _panel(found: Spectra) -> Panel:
    x: Scale = Scale(float(found.frequency[0]), float(found.frequency[-1]), logarithmic=True)
    y = logarithmic(*found.density.values(), most_decades=MOST_DECADES)
    marks = tuple(line(x, y, found.frequency, density, name) for name, density in found.density.items())
    squared = f"{found.unit}^2" if found.unit.isalpha() else f"({found.unit})^2"
    unit = f"{squared}/Hz" if found.unit not in ("", "1") else "1/Hz"
    alt = f"Spectrum of the error of {text.words(found.output)} on logarithmic axes. {_told(found)}"
    return Panel(x, y, "frequency [Hz]", text.axis(f"power density of {found.output}", unit), marks, alt, "tall")


def _told(found: Spectra) -> str:
    first = next(density for name, density in found.density.items() if name != "output")
    return f"The error is strongest at {text.number(float(found.frequency[int(np.argmax(first))]), 2)} Hz."
