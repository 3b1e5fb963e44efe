"""Wall-clock times of rivals, measured side by side."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

LEAST_REPEATS = 5

SETTLE = 0.02
"""Pause before every measurement in s, so that idle worker threads of the rival before have gone to sleep and take no core."""


@dataclass(frozen=True)
class Timing:
    """All measured times of one rival in s."""

    seconds: tuple[float, ...]

    @property
    def median(self) -> float:
        return float(np.median(self.seconds))


def interleaved(rivals: Mapping[str, Callable[[], object]], *, repeats: int = LEAST_REPEATS) -> dict[str, Timing]:
    """Times of every rival, taken in turn (first, second, …, first, second, …) so that a busy moment of the machine hits all alike.

    Each is called once beforehand and not timed. Before each timed call garbage is collected; during it the collector rests.

    Args:
        rivals: by name, what is timed; it must not return before its result is there.
        repeats: timed calls of each, at least five.
    """
    for call in rivals.values():
        call()
    seconds: dict[str, list[float]] = {name: [] for name in rivals}
    for _ in range(max(repeats, LEAST_REPEATS)):
        for name, call in rivals.items():
            seconds[name].append(once(call)[0])
    return {name: Timing(tuple(values)) for name, values in seconds.items()}


def once(call: Callable[[], object]) -> tuple[float, object]:
    """Seconds that one call takes, garbage collected before it, and what it returns."""
    gc.collect()
    time.sleep(SETTLE)
    enabled = gc.isenabled()
    gc.disable()
    try:
        began = time.perf_counter()
        result = call()
        return time.perf_counter() - began, result
    finally:
        if enabled:
            gc.enable()
