"""The ablation as a page: a table and a figure for every case, and what was wanted beside what was measured."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from experiments.ablation.ladder import MODELS
from experiments.ablation.results import Case, Entry
from greybox_torch.files import replacing, write_text
from greybox_torch.report import STYLE

FACTS = ("date", "commit", "processor", "cores", "torch")
BELOW_NAMED, ABOVE_PHYSICS = 0.1, 0.3
"""Points of validation fit by which the hybrid may be behind the named model, and ought to be ahead of the re-estimated physics."""


ROLES = {"estimation": "#8a8a8a", "validation": "#0b6e99"}
"""With their colours."""

LOWEST = 40.0
"""Fit below which a figure has an arrow and the number, so that one poor model does not flatten the others."""

FACTOR = 10.0
"""Relative change from which a drift is told as a factor: the re-estimated physics has that parameter next to zero."""


def write(folder: Path, cases: Sequence[Case]) -> None:
    """results.md, and a figure NAME.png for every case, in ``folder``."""
    for case in cases:
        with replacing(folder / f"{case.name}.png") as path:
            figure_of(case).savefig(path)
    write_text(folder / "results.md", markdown(cases))


def markdown(cases: Sequence[Case]) -> str:
    """The page, every figure in it from the entries."""
    lines = [
        "# What each part of a model brings",
        "",
        "Measured by `python -m experiments.ablation`. Fit in % of free runs, mean over the experiments of a role, start states from the "
        "first tenth of each (the network alone is given its first samples instead). Mean ± standard deviation over the seeds. Drift: "
        "relative change of the physical parameters against the re-estimated physics, median and largest, mean over the seeds. Times are "
        "of the clock and of the processor, of which other jobs may have taken a share.",
    ]
    for case in cases:
        lines += ["", f"## {case.about.get('title', case.name)} (`{case.name}`)", ""]
        if case.about.get("quick"):
            lines += ["**Shrunk to see that it works; the numbers mean nothing.**", ""]
        lines += _table(case) + _choice(case) + _diagnosis(case) + _wanted(case)
        lines += ["", f"![Fits of {case.name}]({case.name}.png)", "", "| | |", "|---|---|"]
        machine = {**case.about.get("machine", {}), **_commits(case)}
        lines += [f"| {name} | {machine[name]} |" for name in FACTS if name in machine]
    return "\n".join(lines) + "\n"


def _table(case: Case) -> list[str]:
    lines = [
        "| model | seeds | estimation fit | validation fit | drift | time | processor time |",
        "|---|---:|---:|---:|---:|---:|---:|",
    ]
    for name, told in MODELS.items():
        own = case.of(name)
        if own:
            fits = [spread([getattr(e, role) for e in own]) for role in ("estimation", "validation")]
            times = [_seconds([getattr(e, kind) for e in own]) for kind in ("seconds", "processor_seconds")]
            count = "" if own[0].seed is None else str(len(own))
            lines.append(f"| {told} | {count} | {fits[0]} | {fits[1]} | {_drift(own)} | {times[0]} | {times[1]} |")
    return lines


def spread(values: Sequence[float]) -> str:
    """Mean and standard deviation, of one value that alone; a run that overflowed has no fit."""
    finite = [v for v in values if np.isfinite(v)]
    if len(finite) < len(values):
        return f"{len(values) - len(finite)} of {len(values)} overflow"
    return f"{np.mean(finite):.2f}" + (f" ± {np.std(finite, ddof=1):.2f}" if len(finite) > 1 else "")


def _seconds(values: Sequence[float]) -> str:
    known = [v for v in values if v > 0]
    return f"{np.mean(known):.0f} s" if known else ""


def _drift(own: Sequence[Entry]) -> str:
    sizes = [{n: abs(v) for n, v in e.drift.items()} for e in own if e.drift]
    if not sizes:
        return ""
    mean = {name: float(np.mean([s[name] for s in sizes])) for name in sizes[0]}
    worst = max(mean, key=lambda name: mean[name])
    if not mean[worst]:
        return "none"
    most = f"{100 * mean[worst]:.0f} %" if mean[worst] < FACTOR else f"× {1 + mean[worst]:.0f}"
    return f"{100 * np.median(list(mean.values())):.0f} %, {worst} {most}"


def _commits(case: Case) -> dict[str, str]:
    """The commits that the entries were measured with, where they say so: an interrupted run may have gone on with another."""
    models: dict[str, list[str]] = {}
    for entry in case.entries:
        if "commit" in entry.detail:
            models.setdefault(entry.detail["commit"], []).append(entry.model)
    told = [f"{commit} ({', '.join(dict.fromkeys(names))})" for commit, names in models.items()]
    return {"commit": "; ".join(told)} if len(models) > 1 else {}


def _choice(case: Case) -> list[str]:
    rows = case.notes.get("networks", [])
    if not rows:
        return []
    told = [
        f"{r['kind']} at {r['port']} reading {' and '.join(r['signals'])} {r['network']:.4g}"
        for r in sorted(rows, key=lambda r: r["share"])
    ]
    return [
        "",
        "The hybrid's network was chosen with seed 0 by the held-out stretches of the estimation experiments (mean squared error; the "
        f"physics alone {rows[0]['physics']:.4g}): {', '.join(told)}.",
    ]


def _diagnosis(case: Case) -> list[str]:
    found = case.notes.get("diagnosis")
    return [] if found is None else ["", f"The diagnosis: {found['sentence']}"]


def _wanted(case: Case) -> list[str]:
    """Whether the hybrid reaches what was asked of it, in figures."""
    mean = {name: float(np.mean([e.validation for e in case.of(name)])) for name in MODELS if case.of(name)}
    mean = {name: value for name, value in mean.items() if np.isfinite(value)}
    lines = []
    for rival, margin in (("named", -BELOW_NAMED), ("physics", ABOVE_PHYSICS)):
        for hybrid in ("hybrid", "hybrid_named"):
            if hybrid in mean and rival in mean:
                reached = "reached" if mean[hybrid] >= mean[rival] + margin else "missed"
                lines.append(
                    f"- {MODELS[hybrid]}: {mean[hybrid]:.2f} %; wanted at least {mean[rival] + margin:.2f} % "
                    f"({MODELS[rival]} {margin:+.1f}): {reached}"
                )
    return ["", *lines] if lines else []


def figure_of(case: Case) -> Figure:
    """Estimation and validation fits by model, a dot for every seed, a line at the mean; runs that overflowed are left out."""
    fits = {
        (name, role): [v for e in case.of(name) if np.isfinite(v := getattr(e, role))]
        for name in MODELS
        for role in ROLES
    }
    names = [name for name in MODELS if all(fits[name, role] for role in ROLES)]
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.4, 1.2 + 0.42 * len(names)), dpi=120, layout="constrained")
        figure.suptitle(f"{case.about.get('title', case.name)}: what each part brings", fontweight="bold")
        axes = figure.subplots()
        for shift, (role, colour) in zip((-0.14, 0.14), ROLES.items(), strict=True):
            axes.plot([], [], "o", color=colour, label=role)
            for row, name in enumerate(names):
                _draw_fits(axes, fits[name, role], row + shift, colour)
        axes.set_yticks(range(len(names)), [MODELS[name] for name in names])
        axes.invert_yaxis()
        axes.margins(x=0.1)
        axes.set_xlabel("fit of free runs [%]")
        axes.legend(loc="best", fontsize=8)
    return figure


def _draw_fits(axes: Axes, fits: Sequence[float], height: float, colour: str) -> None:
    mean, shown = float(np.mean(fits)), np.maximum(fits, LOWEST)
    axes.plot(shown, [height] * len(fits), "o" if min(fits) >= LOWEST else "<", color=colour, markersize=5, alpha=0.7)
    if mean >= LOWEST:
        axes.plot([mean], [height], "|", color=colour, markersize=13, markeredgewidth=2)
    place = {"xytext": (7, 0), "textcoords": "offset points", "va": "center"}
    axes.annotate(f"{mean:.2f}", (max(shown), height), fontsize=7, color=colour, **place)
