"""What drives the experiments: moves, steps, shaking and sweeps, each drawn anew."""

from __future__ import annotations

import numpy as np
from numpy.random import Generator

from experiments.concealed.excitation import moves, multisine, slow_sweep, smooth
from experiments.concealed.workshop.plant import Array


def shaking(rng: Generator, samples: int, sample_time: float, low: float, high: float) -> Array:
    """Broadband between two frequencies [Hz]; RMS about 1."""
    return rng.uniform(0.8, 1.2) * multisine(rng, samples, sample_time, low, high)


def path(rng: Generator, samples: int, corner: float) -> Array:
    """Moves to alternating sides, of 0.6 to 1; corners of so many samples."""
    return moves(rng, samples, samples, corner)


def sweep(rng: Generator, samples: int) -> Array:
    """One to three slow periods, peak 1."""
    return slow_sweep(rng, samples, samples)


def steps(rng: Generator, samples: int, low: float, high: float, *, corner: float = 0.0) -> Array:
    """Levels between `low` and `high`, each held for 4 to 15 % of the record."""
    levels, at = np.empty(samples), 0
    while at < samples:
        length = int(rng.uniform(0.04, 0.15) * samples)
        levels[at : at + length] = rng.uniform(low, high)
        at += length
    return smooth(levels - levels[0], corner) + levels[0] if corner else levels
