"""The figure of a profile likelihood: rise of the cost over a parameter's value, with the 95 % interval."""

from __future__ import annotations

from itertools import pairwise

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from greybox_torch.estimate.profile import THRESHOLD, Profile
from greybox_torch.report.style import STYLE, dots_within, with_unit


def plot_profile(found: Profile, title: str) -> Figure:
    """The profile as computed, the parabola that its standard deviation stands for, and the interval in which it keeps below the level;
    where the estimate is no optimum, the value of the lowest cost in the interval's place.
    """
    height = 3.6
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.0, height), dpi=dots_within(height), layout="constrained")
        axes = figure.subplots()
        axes.set_title(title, fontweight="bold")
        if found.better is None:
            low, high = max(found.lower, found.values[0]), min(found.upper, found.values[-1])
            axes.axvspan(low, high, color="tab:green", alpha=0.15, linewidth=0, label="95 % interval")
            axes.axhline(THRESHOLD, color="tab:green", linewidth=1.0, label="95 % level")
        else:
            axes.axvline(found.better, color="tab:green", linewidth=1.0, label="lower cost: no interval")
        if 0 < found.deviation < np.inf:
            values = np.linspace(found.values[0], found.values[-1], 200)
            parabola = ((values - found.estimate) / found.deviation) ** 2
            axes.plot(values, parabola, "--", color="tab:gray", linewidth=1.0, label="from the standard deviation")
        axes.plot(*_curve(found), color="tab:blue", linewidth=1.2)
        axes.plot(found.values, found.rise, "o", color="tab:blue", markersize=4, label="profile")
        axes.plot([found.estimate], [0.0], "D", color="black", markersize=5, label="estimate")
        axes.set_xlabel(with_unit(found.name, found.unit))
        axes.set_ylabel("rise of the cost [error variances]")
        axes.set_ylim(min(-0.3, 1.1 * float(found.rise.min())), 1.15 * max(float(found.rise.max()), THRESHOLD))
        figure.legend(loc="outside lower center", ncols=3, fontsize=8)
    return figure


def _curve(found: Profile) -> tuple[np.ndarray, np.ndarray]:
    """Points between those computed: the root of the rise taken as linear, as the interval's ends are found."""
    root = np.sign(found.values - found.estimate) * np.sqrt(np.maximum(found.rise, 0.0))
    values = np.concatenate([np.linspace(a, b, 20) for a, b in pairwise(found.values)] or [found.values])
    return values, np.interp(values, found.values, root) ** 2
