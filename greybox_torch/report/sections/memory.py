"""The response of an unknown effect that remembers: amplitude and phase over frequency, with their bands."""

from __future__ import annotations

import numpy as np

from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.memory import Memory
from greybox_torch.report import text
from greybox_torch.report.chart.marks import band, line
from greybox_torch.report.chart.panel import Chart, Key, Panel
from greybox_torch.report.chart.scale import Scale, degrees, logarithmic

SERIES = "effect"


def memory_chart(effect: Effect, memory: Memory) -> Chart:
    """Amplitude and phase of the force that the effect adds, per unit of its signal."""
    x = Scale(float(memory.frequency[0]), float(memory.frequency[-1]), logarithmic=True)
    caption = (
        f"The effect's own response: from {_source(memory)} to the force that it adds at {effect.port}, with two standard deviations on "
        f"either side. {_read(memory)}"
    )
    legend = (Key("law", "the response, with two standard deviations on either side"),)
    return Chart(((_amplitude(x, memory),), (_phase(x, memory),)), caption, legend)


def _amplitude(x: Scale, memory: Memory) -> Panel:
    size = np.abs(memory.gain)
    low, high = np.maximum(size - 2.0 * memory.spread, 1e-6 * size), size + 2.0 * memory.spread
    y = logarithmic(size, low[low > 1e-3 * size], high)
    marks = (band(x, y, memory.frequency, low, high, SERIES), line(x, y, memory.frequency, size, SERIES))
    ends = (text.with_unit(text.number(float(v)), memory.unit) for v in (size[0], size[-1]))
    alt = f"Amplitude of the effect's response over frequency: from {' to '.join(ends)}."
    return Panel(x, y, "frequency [Hz]", text.axis("amplitude", memory.unit), marks, alt, "medium", "How much")


def _phase(x: Scale, memory: Memory) -> Panel:
    phase, spread = np.degrees(memory.phase), np.degrees(memory.turned)
    low, high = phase - 2.0 * spread, phase + 2.0 * spread
    y = degrees(phase, np.clip(low, phase.min() - 90.0, None), np.clip(high, None, phase.max() + 90.0))
    marks = (band(x, y, memory.frequency, low, high, SERIES), line(x, y, memory.frequency, phase, SERIES))
    alt = f"Phase of the effect's response over frequency: from {phase[0]:.0f} to {phase[-1]:.0f} degrees."
    return Panel(x, y, "frequency [Hz]", "phase [°]", marks, alt, "medium", "How late")


def _source(memory: Memory) -> str:
    signal = text.words(memory.signal)
    return f"the curve over {signal}" if memory.curved else signal


def _read(memory: Memory) -> str:
    """How to read it: where the corner lies."""
    corner, what = 1.0 / (2 * np.pi * memory.seconds), "the curve" if memory.curved else "the signal"
    opposed = "" if memory.curved else " At 180° the force opposes the signal."
    return (
        f"It remembers for about {text.number(memory.seconds)} s: well below {text.number(corner)} Hz the force follows {what}, above it "
        f"what was is still felt.{opposed}"
    )
