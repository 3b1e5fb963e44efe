"""One way at one length, in a process of its own, since only that tells how much memory it needs at most.

    python -m experiments.gradients.measure WAY LENGTH WINDOWS UNITS REPEATS

prints a line of JSON.
"""

from __future__ import annotations

import json
import resource
import sys
import time

import numpy as np

from experiments.gradients.task import make_task, make_way, true_slope
from greybox_torch.training.gradients import Batch, SequenceGradient


def measure(way: str, length: int, windows: int, units: int, repeats: int) -> dict[str, float]:
    """Median processor seconds of a gradient, MiB that it needs beyond what the process had before, and how far it is off.

    ``error`` is the distance from the derivative of the solution, relative; ``inconsistency`` that of the slope along one direction
    from the difference of the loss that the way itself computes.
    """
    problem, batch = make_task(windows, length, units)
    gradient = make_way(way, problem)
    small = make_task(windows, 4, units)[1]
    gradient(problem.values, small)  # what is loaded and compiled once is not the gradient's
    before = _peak()
    seconds = []
    for _ in range(repeats):
        began = time.process_time()
        found = gradient(problem.values, batch)
        seconds.append(time.process_time() - began)
    memory = _peak() - before
    exact = true_slope(problem, batch)
    return {
        "seconds": float(np.median(seconds)),
        "memory": memory,
        "error": float(np.linalg.norm(found.slope - exact) / np.linalg.norm(exact)),
        "inconsistency": _inconsistency(gradient, problem.values, problem.free, batch, found.slope),
    }


def _inconsistency(
    gradient: SequenceGradient, values: np.ndarray, free: np.ndarray, batch: Batch, slope: np.ndarray
) -> float:
    direction = np.where(free, 1.0, 0.0)
    direction[free] = slope / np.linalg.norm(slope)
    step = 1e-5
    above, below = (gradient(values + h * direction, batch).energy for h in (step, -step))
    expected = (above - below) / (2 * step)
    return abs(slope @ direction[free] - expected) / abs(expected)


def _peak() -> float:
    """The most memory that the process has had, MiB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


if __name__ == "__main__":
    name, *numbers = sys.argv[1:]
    print(json.dumps(measure(name, *map(int, numbers))))
