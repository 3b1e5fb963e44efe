"""What drives the arm in the four experiments of a case, redrawn for every case.

Like the published experiments: `estimation` and `validation1` follow one square speed profile of +-20 rad/s with
different broadband torques; `validation2` is broadband torque around rest; `validation3` a slow speed profile of up to
+-40 rad/s. All under speed feedback, which carries the noise of the sensor into the input. Before each recording a second
runs unrecorded, so that a recording starts in motion, with wound springs, at an angle that the recording does not tell.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Array = NDArray[np.float64]

EXPERIMENTS = ("estimation", "validation1", "validation2", "validation3")
PRE_ROLL = 1.0  # s
SENSOR_NOISE = 0.05  # rad/s


@dataclass(frozen=True)
class Excitation:
    """Feed-forward torque, speed reference and sensor noise, (samples with the pre-roll, 4); the feedback's two gains."""

    feedforward: Array
    reference: Array
    noise: Array
    gain: float
    integral_gain: float


def multisine(rng: Generator, samples: int, sample_time: float, low: float, high: float) -> Array:
    """Sum of sines of equal amplitude and random phase at every harmonic of the record between two frequencies [Hz]; RMS 1."""
    spectrum = np.zeros(samples // 2 + 1, complex)
    frequency = np.fft.rfftfreq(samples, sample_time)
    band = (frequency >= low) & (frequency <= high)
    spectrum[band] = np.exp(2j * np.pi * rng.random(int(band.sum())))
    signal = np.fft.irfft(spectrum, samples)
    return signal / np.sqrt(np.mean(signal**2))


def smooth(signal: Array, samples_of_lag: float) -> Array:
    """Two first-order lags in a row, at rest at zero to begin with."""
    share = 1.0 / samples_of_lag
    first = second = 0.0
    smoothed = np.empty_like(signal)
    for k, value in enumerate(signal):
        first += share * (value - first)
        second += share * (first - second)
        smoothed[k] = second
    return smoothed


def square_profile(rng: Generator, samples: int, sample_time: float) -> Array:
    """+-20 rad/s, each plateau a seventh to a half of the recording, rounded corners."""
    plateau = rng.uniform(0.14, 0.49) * samples
    forward = np.arange(samples) % (2.0 * plateau) < plateau
    return smooth(np.where(forward, 20.0, -20.0), rng.uniform(0.04, 0.06) / sample_time)


def slow_profile(rng: Generator, samples: int, sample_time: float) -> Array:
    """Sines of 0.1 to 0.6 Hz, scaled to a peak of 40 rad/s."""
    time = np.arange(samples) * sample_time
    frequencies = np.arange(1, 7) * 0.1
    phases = 2.0 * np.pi * rng.random(len(frequencies))
    weights = rng.uniform(0.3, 1.0, len(frequencies))
    profile = (weights * np.sin(2.0 * np.pi * np.outer(time, frequencies) + phases)).sum(axis=1)
    return 40.0 * profile / np.abs(profile).max()


def moves(rng: Generator, total: int, samples: int, samples_of_lag: float) -> Array:
    """A move every 0.1 to 0.25 of the `samples` recorded, to alternating sides and changing places, of 0.6 to 1; rounded corners."""
    targets = np.empty(total)
    at, side = 0, rng.choice([-1.0, 1.0])
    while at < total:
        length = int(rng.uniform(0.1, 0.25) * samples)
        targets[at : at + length] = side * rng.uniform(0.6, 1.0)
        at, side = at + length, -side
    return smooth(targets, samples_of_lag)


def slow_sweep(rng: Generator, total: int, samples: int) -> Array:
    """Sines of one, two and three periods in the `samples` recorded, scaled to a peak of 1."""
    turn = 2.0 * np.pi * np.arange(total) / samples
    waves = sum(rng.uniform(0.4, 1.0) * np.sin(n * turn + rng.uniform(0.0, 2.0 * np.pi)) for n in (1, 2, 3))
    return np.asarray(waves) / np.abs(waves).max()


def draw_excitation(rng: Generator, samples: int, sample_time: float) -> Excitation:
    """One case's four experiments of `samples` recorded samples each."""
    before = round(PRE_ROLL / sample_time)
    total = before + samples
    level = rng.uniform(2.3, 2.9)
    feedforward = np.stack(
        [level * multisine(rng, total, sample_time, 1.0, 40.0) for _ in range(3)] + [np.zeros(total)], axis=1
    )
    square = square_profile(rng, samples, sample_time)
    entry = 20.0 * rng.choice([-1.0, 1.0])
    slow = slow_profile(rng, samples, sample_time)
    rest = np.zeros(total)
    square = np.concatenate([np.full(before, entry), square])
    slow = np.concatenate([smooth(np.full(before, slow[0]), 0.05 / sample_time), slow])
    reference = np.stack([square, square, rest, slow], axis=1)
    noise = SENSOR_NOISE * rng.standard_normal((total, 4))
    return Excitation(feedforward, reference, noise, rng.uniform(0.55, 0.65), rng.uniform(4.0, 8.0))
