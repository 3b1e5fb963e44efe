"""The figures of the proof: what was said against what was concealed, detection against strength, closure, reliability."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from experiments.concealed.proof.confusion import matrix
from experiments.concealed.visibility import DOMINANT, MODERATE, OVERWHELMING
from experiments.verdicts.calibrate import KINDS, claims_of, reliability
from experiments.verdicts.calibration_page import draw as draw_reliability
from experiments.verdicts.rates import Rate
from experiments.verdicts.scoring import Scored

EDGES = (0.0, 2.0, 4.0, MODERATE, 12.0, DOMINANT, OVERWHELMING, np.inf)
COLOURS = {"weak": "#9aa5b1", "moderate": "#3b7dd8", "dominant": "#123a6d", "overwhelming": "#8a2be2"}
LEAST_SHOWN, MOST_SHOWN = 0.5, 5000.0


def draw_all(found: Sequence[Scored], folder: Path) -> list[str]:
    """Write every figure that the cases allow; their file names."""
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for name, draw in (
        ("confusion.png", _confusion),
        ("strength.png", _strength),
        ("closure.png", _closure),
        ("reliability.png", _reliability),
    ):
        if draw(found, folder / name):
            written.append(name)
    return written


def _pyplot() -> Any:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    return pyplot


def _save(figure: Any, file: Path) -> bool:
    figure.savefig(file, dpi=130)
    _pyplot().close(figure)
    return True


def _confusion(found: Sequence[Scored], file: Path) -> bool:
    """Rows: what is concealed, by kind of port; columns: what was said. Right answers lie on the diagonal, twins included."""
    labels, columns, counts = matrix(found)
    if not labels:
        return False
    pyplot = _pyplot()
    figure, axes = pyplot.subplots(figsize=(2.6 + 0.27 * len(columns), 2.4 + 0.24 * len(labels)), layout="constrained")
    shares = counts / np.maximum(counts.sum(axis=1, keepdims=True), 1)
    shown = np.where(counts > 0, 0.15 + 0.85 * shares, 0.0)
    axes.imshow(shown, cmap="Blues", vmin=0.0, vmax=2.0, aspect="auto")  # light, so that the counts can be read
    for i, j in zip(*np.nonzero(counts), strict=True):
        wrong = labels[i] != columns[j]
        axes.text(j, i, counts[i, j], ha="center", va="center", fontsize=7, color="#b00020" if wrong else "black")
    axes.set_xticks(range(len(columns)), columns, rotation=90, fontsize=7)
    axes.set_yticks(range(len(labels)), labels, fontsize=7)
    axes.set_xticks(np.arange(-0.5, len(columns)), minor=True)
    axes.set_yticks(np.arange(-0.5, len(labels)), minor=True)
    axes.grid(which="minor", color="0.92", lw=0.6)
    axes.tick_params(which="both", length=0)
    axes.set(xlabel="said", ylabel="concealed")
    return _save(figure, file)


def _strength(found: Sequence[Scored], file: Path) -> bool:
    """Shares of cases detected and of effects located and named, against how visible the effect is."""
    cases = [r for r in found if r.effects and not r.outside]
    if not cases:
        return False
    pyplot = _pyplot()
    figure, axes = pyplot.subplots(figsize=(6.4, 4.0), layout="constrained")
    seen = np.array([_shown(r) for r in cases])
    for offset, colour, label in ((-1, "#123a6d", "detected"), (0, "#3b7dd8", "located"), (1, "#d9822b", "named")):
        x, y, low, high = [], [], [], []
        for start, end in pairwise(EDGES):
            own = [r for r, v in zip(cases, seen, strict=True) if start <= v < end]
            if not own:
                continue
            rate = _rate(own, label)
            x.append(np.exp(np.mean(np.log([_shown(r) for r in own]))) * 1.04**offset)
            y.append(rate.share)
            low.append(rate.share - rate.interval[0])
            high.append(rate.interval[1] - rate.share)
        axes.errorbar(x, y, yerr=(low, high), color=colour, label=label, marker="o", ms=4, lw=1.2, capsize=2)
    axes.plot(seen, np.full(len(seen), -0.06), "|", color="0.5", ms=6)
    for edge in (MODERATE, DOMINANT, OVERWHELMING):
        axes.axvline(edge, color="0.85", lw=1, zorder=0)
    for word, at in (("weak", 1.7), ("moderate", 13.0), ("dominant", 75.0), ("overwhelming", 1000.0)):
        axes.text(at, 1.06, word, color="0.45", fontsize=8, ha="center")
    axes.set(xscale="log", xlim=(LEAST_SHOWN, MOST_SHOWN), ylim=(-0.1, 1.12), ylabel="share (95 % interval)")
    axes.set_xlabel("visibility: error of the refitted plain model, in units of the floor")
    ticks = (0.5, 1, 2, 5, 10, 30, 100, 300, 1000, 3000)
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.minorticks_off()
    axes.legend(frameon=False, loc="lower right", bbox_to_anchor=(1.0, 0.06))
    return _save(figure, file)


def _shown(row: Scored) -> float:
    return float(np.clip(row.key["visibility"], 1.05 * LEAST_SHOWN, MOST_SHOWN / 1.1))


def _rate(cases: Sequence[Scored], what: str) -> Rate:
    if what == "detected":
        return Rate(sum(r.detected for r in cases), len(cases))
    hits = sum(r.located if what == "located" else r.named for r in cases)
    return Rate(hits, sum(len(r.effects) for r in cases))


def _closure(found: Sequence[Scored], file: Path) -> bool:
    """How many cases have at least so much of their error closed, by strength."""
    cases = [r for r in found if r.closed is not None]
    if not cases:
        return False
    pyplot = _pyplot()
    figure, axes = pyplot.subplots(figsize=(6.4, 3.4), layout="constrained")
    for word, colour in COLOURS.items():
        values = np.sort([max(float(r.closed), 0.0) for r in cases if r.strength == word and r.closed is not None])
        if len(values):
            share = np.arange(len(values), 0, -1) / len(values)
            axes.step(
                np.concatenate([[0.0], values]),
                np.concatenate([[1.0], share]),
                color=colour,
                label=f"{word} ({len(values)})",
            )
    axes.axvline(0.95, color="0.8", lw=1, zorder=0)
    axes.set(xlim=(0, 1), ylim=(0, 1.03), xlabel="share of the validation error above the floor that is closed",
             ylabel="share of cases with at least that")  # fmt: skip
    axes.legend(frameon=False, loc="lower left")
    return _save(figure, file)


def _reliability(found: Sequence[Scored], file: Path) -> bool:
    findings = [f for r in found for f in r.findings]
    if not findings:
        return False
    told = {what: [claim for f in findings for claim in claims_of(f, what)] for what in KINDS}
    bins = {what: reliability(*np.array(claims, dtype=float).T) for what, claims in told.items()}
    draw_reliability(list(bins.items()), file)
    return True
