"""The folder of a case: the card, the recordings in the units of their columns, samples missing."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.random import Generator

from experiments.concealed.workshop.integrate import Experiment
from experiments.concealed.workshop.plant import Array, Machine


def lose(rng: Generator, outputs: Array) -> None:
    """Two stretches of 1 % of the record, and single samples, of one output."""
    row = int(rng.integers(outputs.shape[1]))
    for _ in range(2):
        at = int(rng.integers(len(outputs) * 99 // 100))
        outputs[at : at + len(outputs) // 100, row] = np.nan
    outputs[rng.integers(0, len(outputs), 10), row] = np.nan


def write_table(file: Path, machine: Machine, run: Experiment, scales: list[float]) -> None:
    channels = (*machine.inputs, *machine.outputs)
    table = np.concatenate([run.inputs, run.outputs], axis=1) / np.array(scales)
    header = ",".join(c.column for c in channels)
    np.savetxt(file, table, fmt="%.9g", delimiter=",", header=header, comments="")


def card_text(machine: Machine, rng: Generator, truth: Mapping[str, float], scales: list[float]) -> str:
    lines = [
        f'name = "Workshop, {machine.name}"',
        f"sample_time = {machine.sample_time}",
        'hold = "zoh"',
        "",
        "[channels]",
    ]
    for c, value in zip((*machine.inputs, *machine.outputs), scales, strict=True):
        scale = "" if value == 1.0 else f", scale = {value:.17g}"
        lines.append(f'{c.name} = {{ column = "{c.column}", unit = "{c.unit}"{scale} }}')
    for j in range(machine.experiments):
        role = "estimation" if j == 0 else "validation"
        lines += ["", "[[experiment]]", f'name = "e{j}"', f'file = "e{j}.csv"', f'role = "{role}"']
    lines += ["", "[model]", f'name = "model.py:{machine.model}"', "", "[model.parameters]"]
    for name, value in truth.items():
        if name in machine.known:
            lines.append(f"{name} = {{ value = {value:.8g}, fixed = true }}")
        else:
            lines.append(f"{name} = {{ value = {value * (1.0 + rng.uniform(-0.15, 0.15)):.6g} }}")
    return "\n".join(lines) + "\n"
