"""The page on gradients: a table, a figure, and what follows from them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from experiments.gradients.task import WAYS
from experiments.speed.writers import duration
from greybox_torch.files import json_text, replacing, write_text

COLOURS = ("#0b6e99", "#c8553d", "#8a8a8a", "#6a7f3f")
FACTS = ("commit", "date", "processor", "cores", "torch", "torchdiffeq")

Row = Mapping[str, Any]


def write(folder: Path, result: Mapping[str, Any]) -> None:
    """gradients.md, gradients.png and gradients.json in ``folder``."""
    _draw(result["rows"], folder / "gradients.png")
    write_text(folder / "gradients.json", json_text(dict(result)))
    write_text(folder / "gradients.md", markdown(result))


def markdown(result: Mapping[str, Any]) -> str:
    """The page, every figure in it from ``result``."""
    rows, machine = result["rows"], result["machine"]
    lines = [
        "# Three gradients, and when each pays",
        "",
        f"`greybox train --gradient NAME`. Measured: the loss of {result['windows']} windows of the robot arm and its gradient by the "
        f"{result['weights']} weights of a network at its motor, in float64, on one core, by `python -m experiments.gradients --out docs`.",
        "",
    ]
    if result["quick"]:
        lines += ["**Shrunk to see that it works; the numbers mean nothing.**", ""]
    lines += _advice(rows)
    lines += ["", "![Time, memory and error over the length of a window](gradients.png)", ""]
    for title, key, told in (
        ("Processor time of a gradient", "seconds", duration),
        ("Memory beyond that of the process, MiB", "memory", lambda v: f"{v:.3g}"),
        ("Distance from the derivative of the solution, relative", "error", lambda v: f"{v:.1e}"),
        ("Distance from the difference of the computed loss, relative", "inconsistency", lambda v: f"{v:.1e}"),
    ):
        lines += [f"## {title}", "", *_table(rows, key, told), ""]
    lines += [
        "The solution is what steps sixteen times as fine give. The difference of the computed loss is taken along the gradient, from two "
        "points, and is itself good to about 1e-9. Memory is the peak of the process during the gradients, less that before.",
        "",
        "| | |",
        "|---|---|",
        *[f"| {name} | {machine[name]} |" for name in FACTS if name in machine],
    ]
    return "\n".join(lines) + "\n"


def _advice(rows: Sequence[Row]) -> list[str]:
    """When each pays, in the figures of the longest windows."""
    longest = max(row["length"] for row in rows)
    at = {row["way"]: row for row in rows if row["length"] == longest}
    tangents, again, kept, adjoint = (at[way] for way in WAYS)
    ratio = again["seconds"] / tangents["seconds"]
    return [
        "- **`tangents`** (default): one forward pass of compiled code that carries a sensitivity for each weight. Exact for the steps "
        f"that are made, {ratio:.0f} times as fast as recomputation at {longest} samples, and its normal matrix serves Gauss-Newton "
        "as well. "
        "Its time grows with the number of weights: for thousands of them, or without a compiler, take another.",
        "- **`recomputation`**: backpropagation through the steps, the steps between two kept states computed again. Exact for the steps "
        "too; time hardly depends on the number of weights; memory grows with the root of the length: "
        f"{again['memory']:.3g} MiB at {longest} samples, where keeping every state takes {kept['memory']:.3g} MiB. For large networks.",
        "- **`odeint_adjoint`**: the adjoint equation, solved backwards by torchdiffeq. Memory does not grow with what happens between two "
        f"samples ({adjoint['memory']:.3g} MiB); its slope is {adjoint['inconsistency']:.0e} off that of the loss which is computed at "
        f"{longest} samples, where the other two are right to rounding, and it takes {duration(adjoint['seconds'])}. For comparison with "
        "work that uses it.",
    ]


def _table(rows: Sequence[Row], key: str, told: Callable[[float], str]) -> list[str]:
    lengths = sorted({row["length"] for row in rows})
    lines = ["| samples | " + " | ".join(f"`{way}`" for way in WAYS) + " |", "|---:|" + "---:|" * len(WAYS)]
    for length in lengths:
        cells = [told(next(r[key] for r in rows if r["way"] == way and r["length"] == length)) for way in WAYS]
        lines.append(f"| {length} | " + " | ".join(cells) + " |")
    return lines


def _draw(rows: Sequence[Row], file: Path) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.0, 3.8), layout="constrained")
    panels = (
        ("seconds", "processor time of a gradient in s"),
        ("memory", "memory in MiB"),
        ("inconsistency", "error of the slope"),
    )
    for axes, (key, label) in zip(figure.subplots(1, 3), panels, strict=True):
        for colour, way in zip(COLOURS, WAYS, strict=True):
            own = [(r["length"], max(r[key], 1e-16)) for r in rows if r["way"] == way]
            axes.loglog(*zip(*own, strict=True), "o-", color=colour, linewidth=1.8, markersize=5, label=way)
        if key == "memory":
            axes.set_ylim(bottom=0.5)
        axes.set_xlabel("samples of a window")
        axes.set_ylabel(label)
        axes.grid(which="major", color="#d9d9d9", linewidth=0.8)
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
        if key == "seconds":
            axes.legend(frameon=False, fontsize=8)
    with replacing(file) as temporary:
        figure.savefig(temporary, dpi=150)
