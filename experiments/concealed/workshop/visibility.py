"""What stays of an effect once the plain model is refitted: by the machine's own equations, in linearisation."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from experiments.concealed.workshop.integrate import Experiment, simulate
from experiments.concealed.workshop.plant import Array, Concealed, Drive, Machine

REPLAY = 3
"""Steps in a sample."""


def left_by_a_refit(
    machine: Machine, truth: Mapping[str, float], runs: list[Experiment], starts: list[list[float]], usual: Array
) -> float:
    """RMS of what a refit of the plain model leaves, in units of the outputs' usual size."""
    silent = np.zeros((machine.samples, len(machine.outputs)))
    still = [0.0] * len(machine.outputs)
    none = Drive(np.zeros((machine.samples, 0)), np.zeros((machine.samples, 0)))

    def shown(p: Mapping[str, float], start: list[float], j: int) -> Array:
        run = simulate(
            machine, p, none, Concealed(), start=start, noise=silent, resolution=still, replay=runs[j].inputs,
            substeps=REPLAY if machine.substeps > REPLAY else machine.substeps,
        )  # fmt: skip
        return run.outputs / usual

    free = [name for name in machine.truth if name not in machine.known]
    base = [shown(truth, start, j) for j, start in enumerate(starts)]
    columns = []
    for name in free:
        moved = {**truth, name: truth[name] * 1.001}
        columns.append(np.concatenate([(shown(moved, s, j) - base[j]).ravel() for j, s in enumerate(starts)]))
    for j, start in enumerate(starts):
        for i in range(len(machine.states)):
            size = 1e-4 * max(float(np.abs(runs[j].states[:, i]).max()), 1e-9)
            moved_start = [x + size * (m == i) for m, x in enumerate(start)]
            parts = [np.zeros(b.size) for b in base]
            parts[j] = (shown(truth, moved_start, j) - base[j]).ravel()
            columns.append(np.concatenate(parts))
    error = np.concatenate([(run.outputs / usual - b).ravel() for run, b in zip(runs, base, strict=True)])
    design = np.stack(columns, axis=1)
    design = design / np.maximum(np.linalg.norm(design, axis=0), 1e-30)
    keep = np.isfinite(design).all(axis=0)
    fitted = design[:, keep] @ np.linalg.lstsq(design[:, keep], error, rcond=1e-9)[0]
    return float(np.sqrt(np.mean((error - fitted) ** 2)))
