"""The figure of what a network has learned: its mean force over each signal with a band, and the laws that were put in its place."""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
import torch
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from greybox_torch.mechanisms.matching import law_force
from greybox_torch.report.style import STYLE, dots_within, with_unit
from greybox_torch.training import Explanation, Trained
from greybox_torch.training.learned_force import SignalCurve

LAW_COLOURS = ("#c8553d", "#6a7f3f", "#8a5fa8")


def plot_learned(found: Trained, explained: Explanation, title: str) -> Figure:
    """A panel for every signal; the laws, as estimated in the network's place, where it reads one signal."""
    curves, network = explained.curves, found.hybrid.network
    height = 3.4
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(1.5 + 4.5 * len(curves), height), dpi=dots_within(height), layout="constrained")
        figure.suptitle(title, fontweight="bold")
        panels = np.atleast_1d(figure.subplots(1, len(curves), sharey=True))
        for axes, curve in zip(panels, curves, strict=True):
            _draw(axes, curve)
            axes.set_xlabel(with_unit(curve.signal, curve.unit))
        panels[0].set_ylabel(with_unit(f"force at {network.port}", found.hybrid.surroundings[network.port].force_unit))
        if len(curves) == 1:
            _draw_laws(panels[0], curves[0], found, explained)
        panels[0].legend(fontsize=8)
    return figure


def _draw(axes: Axes, curve: SignalCurve) -> None:
    low, high = curve.force - 2 * curve.deviation, curve.force + 2 * curve.deviation
    axes.fill_between(curve.values, low, high, color="#0b6e99", alpha=0.2, linewidth=0, label="two deviations")
    axes.plot(curve.values, curve.force, color="#0b6e99", linewidth=1.6, label="learned")
    axes.axhline(0.0, color="black", linewidth=0.6)
    axes.set_title(f"explains {100 * curve.share:.0f} % of its variance", fontsize=9)


def _draw_laws(axes: Axes, curve: SignalCurve, found: Trained, explained: Explanation) -> None:
    around = found.hybrid.surroundings[found.hybrid.network.port]
    values = np.linspace(curve.values[0], curve.values[-1], 300)
    drawn = [term for term in explained.terms if term.match is not None]
    for term, colour in zip(drawn, LAW_COLOURS, strict=False):
        force = law_force(term.attachment.mechanism, around, {curve.signal: torch.as_tensor(values)}, term.parameters)
        axes.plot(values, force, "--", color=colour, linewidth=1.1, label=term.attachment.mechanism.name)
