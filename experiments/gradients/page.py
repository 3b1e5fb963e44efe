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
        f"{result['weights']} weights of a network at its motor, in float64, on one core, by "
        "`python -m experiments.gradients --out docs/validation`.",
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
        "points. Memory is the peak of the process during the gradients, less its peak before: 0 means that the gradient needed less than "
        "loading and compiling had, not that it needed none, and such points are missing from the figure. Times are "
        "processor seconds, which "
        "other jobs on the machine change less than elapsed time, but not by nothing.",
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
        "as well. It needs a compiler to be so fast.",
        "- **`recomputation`**: backpropagation through the steps, the steps between two kept states computed again. Exact for the steps "
        f"too; {again['memory']:.3g} MiB at {longest} samples, where keeping every state takes {kept['memory']:.3g} "
        f"MiB, for about the same "
        "time. Where windows are long and there is no compiler.",
        "- **`odeint_adjoint`**: the adjoint equation, solved backwards by torchdiffeq. Its slope is "
        f"{adjoint['inconsistency']:.0e} off that of the loss which is computed at {longest} samples, where the other two are right to "
        f"rounding; it takes {duration(adjoint['seconds'])} and {adjoint['memory']:.3g} MiB. For comparison with work that uses it.",
        "",
        "Only the length of the windows was varied. How the ways compare for networks of hundreds or thousands of "
        "weights, and on a GPU, was "
        "not measured.",
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
            own = [(r["length"], r[key]) for r in rows if r["way"] == way and r[key] > 0]
            axes.loglog(
                [n for n, _ in own], [v for _, v in own], "o-", color=colour, linewidth=1.8, markersize=5, label=way
            )
        if key == "memory":
            axes.set_ylim(bottom=0.5)
        axes.set_xticks(
            sorted({r["length"] for r in rows}), labels=[str(n) for n in sorted({r["length"] for r in rows})]
        )
        axes.minorticks_off()
        axes.set_xlabel("samples of a window")
        axes.set_ylabel(label)
        axes.grid(which="major", color="#d9d9d9", linewidth=0.8)
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
        if key == "seconds":
            axes.legend(frameon=False, fontsize=8)
    with replacing(file) as temporary:
        figure.savefig(temporary, dpi=150)
