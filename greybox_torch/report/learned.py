"""The figure of what a network has learned: its mean force over each signal with a band, and the laws that were put in its place.

A law is estimated together with the physics, which then may hold a constant that the network held before, or the other way round.
"""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
import torch
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from greybox_torch.diagnosis.digits import digits
from greybox_torch.mechanisms.matching import law_force
from greybox_torch.name_lists import listed
from greybox_torch.report import text
from greybox_torch.report.style import STYLE, dots_within, with_unit
from greybox_torch.training import Explanation, Trained
from greybox_torch.training.learned_force import SignalCurve
from greybox_torch.training.named_term import NamedTerm

OWN_MOVED = 0.05
"""Part by which a parameter of the physics is another beside a law than beside the network, from where on the figure says so."""

MOVED = "laws are drawn with the constant and slope that the physics, estimated anew with them, takes over"

HARDLY_SEEN = 0.02
"""Share of the learned curve's height by which a law that lies beside it is drawn where it is."""

LAW_COLOURS = ("#c8553d", "#6a7f3f", "#8a5fa8")


def plot_learned(found: Trained, explained: Explanation, title: str) -> Figure:
    """A panel for every signal; the laws, as estimated in the network's place, where it reads one signal."""
    curves, network, moved = explained.curves, found.hybrid.network, False
    height = 3.9
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(1.5 + 4.5 * len(curves), height), dpi=dots_within(height), layout="constrained")
        figure.suptitle(title, fontweight="bold")
        panels = np.atleast_1d(figure.subplots(1, len(curves), sharey=True))
        for axes, curve in zip(panels, curves, strict=True):
            _draw(axes, curve)
            axes.set_xlabel(with_unit(curve.told, curve.unit))
        panels[0].set_ylabel(
            with_unit(f"{found.hybrid.adds} at {network.port}", found.hybrid.surroundings[network.port].force_unit)
        )
        if len(curves) == 1:
            moved = _draw_laws(panels[0], curves[0], found, explained)
        # below the panels, where it hides nothing
        notes = [*([MOVED] if moved else []), *(taken_over(found, explained) if len(curves) == 1 else [])]
        told = {"title": "\n".join(notes), "title_fontsize": 7, "alignment": "left"} if notes else {}
        figure.legend(
            *panels[0].get_legend_handles_labels(),
            loc="outside lower center",
            ncols=2 if len(curves) == 1 else 3,
            fontsize=8,
            **told,
        )
    return figure


def _draw(axes: Axes, curve: SignalCurve) -> None:
    low, high = curve.force - 2 * curve.deviation, curve.force + 2 * curve.deviation
    axes.fill_between(curve.values, low, high, color="#0b6e99", alpha=0.2, linewidth=0, label="two deviations")
    axes.plot(curve.values, curve.force, color="#0b6e99", linewidth=1.6, label="learned")
    axes.axhline(0.0, color="black", linewidth=0.6)
    told = f"{100 * curve.share:.0f} % of the variance of what was learned is a function of {curve.told} alone"
    if curve.zero_within > 0:
        told += f"\nzero lies within the band over {100 * curve.zero_within:.0f} % of what was visited"
    axes.set_title(told, fontsize=9)


def _draw_laws(axes: Axes, curve: SignalCurve, found: Trained, explained: Explanation) -> bool:
    """Draws them; whether any is drawn with a constant."""
    around = found.hybrid.surroundings[found.hybrid.network.port]
    values = np.linspace(curve.values[0], curve.values[-1], 300)
    unit, moved, slopes = around.force_unit, False, bool(explained.own)
    for term, colour in zip(_drawn(explained), LAW_COLOURS, strict=False):
        mechanism = term.attachment.mechanism
        force = law_force(mechanism, around, {curve.signal: torch.as_tensor(values)}, term.parameters)
        offset, slope = line_beside(curve, values, force, slopes)
        moved |= offset != 0.0 or slope != 0.0
        by = f" {'+' if offset > 0 else '−'} {text.with_unit(digits(abs(offset)), unit)}" if offset else ""
        by += f" {'+' if slope > 0 else '−'} {digits(abs(slope))} {curve.told}" if slope else ""
        axes.plot(
            values, force + offset + slope * values, "--", color=colour, linewidth=1.1, label=f"{mechanism.name}{by}"
        )
    return moved


def _drawn(explained: Explanation) -> list[NamedTerm]:
    return [term for term in explained.terms if term.match is not None][: len(LAW_COLOURS)]


def taken_over(found: Trained, explained: Explanation) -> list[str]:
    """For every law that is drawn, a line of the parameters of the physics that do in the curve's place what the law does not, or the other
    way round: with another damping beside it a law lies beside the curve, and does the same.
    """
    problem = found.result.problem
    units, beside = {p.name: p.unit for p in problem.model.declared_parameters}, problem.values_by_name
    lines = []
    for term in _drawn(explained):
        own = {name: (term.problem.values_by_name[name], beside[name]) for name in explained.own}
        moved = [
            name for name, (now, before) in own.items() if abs(now - before) > OWN_MOVED * max(abs(now), abs(before))
        ]
        told = [
            f"{text.with_unit(f'{name} = {digits(own[name][0])}', units[name])} (beside the network {digits(own[name][1])})"
            for name in moved
        ]
        if told:
            what = f"what {listed(moved)} {'adds' if len(moved) == 1 else 'add'} is in neither curve"
            lines.append(f"beside {term.attachment.mechanism.name} is estimated {listed(told)}; {what}")
    return lines


def line_beside(curve: SignalCurve, values: np.ndarray, force: np.ndarray, slopes: bool) -> tuple[float, float]:
    """Constant and slope of the line by which the learned curve lies above a law's ``force`` (N,) over ``values`` (N,); zero where that is
    hardly seen.

    Args:
        slopes: whether parameters of the physics act as a force there as well, such as a damping; else the slope is zero.
    """
    above, height = curve.force - np.interp(curve.values, values, force), HARDLY_SEEN * float(np.ptp(curve.force))
    slope = float(np.polyfit(curve.values, above, 1)[0]) if slopes else 0.0
    slope = slope if abs(slope) * float(np.ptp(curve.values)) > height else 0.0
    offset = float(np.mean(above - slope * curve.values))
    return (offset if abs(offset) > height else 0.0), slope
