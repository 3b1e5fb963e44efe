"""Frequency responses of recordings, with their uncertainty, by the local polynomial method.

Around every frequency the response, and the transient that a record begins and ends with, are smooth: both are taken as polynomials there
and fitted to the lines of the discrete Fourier transform nearby. The transient is what a window would smear into the response. What the
fit leaves is noise, and what a linear response cannot follow; it gives the variance of the estimate.

Source: R. Pintelon, J. Schoukens, System Identification: A Frequency Domain Approach, 2nd ed., 2012, ch. 7.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from greybox_torch.linear_algebra import least_squares

ORDER = 2
"""Of the polynomials, of response and transient alike."""

HALF_BAND = 0.03
"""Lines on either side of a frequency, as a share of it, that its estimate is made from."""

SPARE = 8
"""Lines at least that an estimate has beyond its unknowns."""

HANN = 0.375
"""Mean square of the window."""

FLAT = 1e-15
"""Smallest singular value, beside the largest: what rounding leaves of one that is zero."""

SMOOTH = 1e-5
"""Share of an input's power around a frequency that has to be beside what is smooth over it as the transient is. What begins and ends at
different values has smooth lines at all frequencies: of sines up to 5 Hz all but 2e-6 at 9 Hz and 1e-8 at 14 Hz; of the same sines rounded
to a thousandth, all but 1e-5 to 1e-2.
"""

HIGHEST = 0.45
"""Of the sampling frequency: beyond it nothing is estimated."""


@dataclass(frozen=True)
class Response:
    """From n_u inputs to n_y outputs at F frequencies (Hz): the complex response ``gain`` (n_y, n_u, F), and the variance (n_y, n_u, F) of
    its distance from the true one in the complex plane. ``inputs`` (n_u, F) and ``outputs`` (n_y, F) are the signals' power around a
    frequency, a line of the transform divided by the root of the number of samples, behind a window of Hann.
    """

    frequency: np.ndarray
    gain: np.ndarray
    variance: np.ndarray
    inputs: np.ndarray
    outputs: np.ndarray


@dataclass(frozen=True)
class _Lines:
    """Fourier transforms of inputs (n_u, K) and outputs (n_y, K) of one record at its frequencies (K,) in Hz, above zero.

    ``power`` (n_u + n_y, K), of both behind a window: without it, what is strong at low frequencies would leak into the others.
    """

    frequency: np.ndarray
    u: np.ndarray
    y: np.ndarray
    power: np.ndarray


def frequency_response(
    inputs: Sequence[np.ndarray], outputs: Sequence[np.ndarray], sample_time: float, per_decade: int = 30
) -> Response | None:
    """The response that records have in common; None where they are too short for one.

    Args:
        inputs: a record each, (n_u, N) without gaps.
        outputs: likewise (n_y, N).
        sample_time: of all, in s.
    """
    lines = [_lines(u, y, sample_time) for u, y in zip(inputs, outputs, strict=True) if u.shape[1]]
    n_u = len(inputs[0]) if inputs else 0
    resolution = min((one.frequency[0] for one in lines if len(one.frequency)), default=np.inf)
    fewest = (ORDER + 1) * (n_u + 1) + SPARE
    frequencies = _grid(0.5 * fewest * resolution, HIGHEST / sample_time, per_decade)
    found = [_estimate(lines, f, 0.5 * fewest * resolution, n_u) for f in frequencies]
    kept = [(f, *one) for f, one in zip(frequencies, found, strict=True) if one is not None]
    if not kept:
        return None
    frequency, *parts = (np.array(part) for part in zip(*kept, strict=True))
    return Response(frequency, *(np.moveaxis(part, 0, -1) for part in parts))


def _lines(u: np.ndarray, y: np.ndarray, sample_time: float) -> _Lines:
    size = u.shape[1]
    scale = 1.0 / np.sqrt(size)
    both = np.concatenate([u, y])
    both = both - both.mean(axis=1, keepdims=True)
    spectrum = np.fft.rfft(both, axis=1)[:, 1:] * scale
    windowed = np.fft.rfft(both * np.hanning(size), axis=1)[:, 1:] * scale
    power = np.abs(windowed) ** 2 / HANN
    return _Lines(np.fft.rfftfreq(size, sample_time)[1:], spectrum[: len(u)], spectrum[len(u) :], power)


def _grid(low: float, high: float, per_decade: int) -> np.ndarray:
    if not low < high < np.inf:
        return np.zeros(0)
    return np.geomspace(low, high, max(2, int(per_decade * np.log10(high / low)) + 1))


def _estimate(lines: Sequence[_Lines], frequency: float, least: float, n_u: int) -> tuple[np.ndarray, ...] | None:
    """Response and variance (n_y, n_u), and powers (n_u,) and (n_y,), at one frequency; None where there are too few lines around it."""
    half, powers = max(least, HALF_BAND * frequency), np.arange(ORDER + 1)[:, None]
    blocks, wanted, power = [], [], []
    for one in lines:
        first, last = np.searchsorted(one.frequency, [frequency - half, frequency + half])
        if last - first <= 2 * (ORDER + 1):
            continue  # the record's own transient would take them all
        away = (one.frequency[first:last] - frequency) / half
        shape = away[None, :] ** powers
        blocks.append((np.concatenate([row * shape for row in one.u[:, first:last]]), shape))
        power.append(one.power[:, first:last])
        wanted.append(one.y[:, first:last])
    unknowns = (ORDER + 1) * (n_u + len(blocks))
    count = sum(shape.shape[1] for _, shape in blocks)
    if count < unknowns + SPARE // 2:
        return None
    matrix = np.zeros((count, unknowns), dtype=complex)
    at = 0
    for k, (response, transient) in enumerate(blocks):
        rows, own = slice(at, at + transient.shape[1]), (ORDER + 1) * (n_u + k)
        matrix[rows, : (ORDER + 1) * n_u] = response.T
        matrix[rows, own : own + ORDER + 1] = transient.T
        at = rows.stop
    mean = np.mean(np.concatenate(power, axis=1), axis=1)
    return (*_solved(matrix, np.concatenate(wanted, axis=1).T, n_u), mean[:n_u], mean[n_u:])


def _excited(matrix: np.ndarray, n_u: int) -> np.ndarray:
    """Whether each input (n_u,) has power around a frequency beside what is smooth over it, as the transient is."""
    inputs, transients = matrix[:, : (ORDER + 1) * n_u : ORDER + 1], matrix[:, (ORDER + 1) * n_u :]
    own = inputs - transients @ least_squares(transients, inputs)
    return np.sum(np.abs(own) ** 2, axis=0) > SMOOTH * np.sum(np.abs(inputs) ** 2, axis=0)


def _solved(matrix: np.ndarray, wanted: np.ndarray, n_u: int) -> tuple[np.ndarray, np.ndarray]:
    """The constant terms (n_y, n_u) of the response's polynomials, and their variances."""
    size = np.sqrt(np.mean(np.abs(matrix) ** 2, axis=0))
    scale = np.where(size > 0, size, 1.0)
    found = least_squares(matrix / scale, wanted)
    left = wanted - (matrix / scale) @ found
    noise = np.sum(np.abs(left) ** 2, axis=0) / (len(matrix) - matrix.shape[1])
    spread = _inverse_diagonal(matrix / scale)
    constant = np.arange(n_u) * (ORDER + 1)
    # An input that is at rest shows no response, nor does one by the ends of its records alone.
    there = _excited(matrix, n_u)
    gain = np.where(there, found[constant].T / scale[constant], 0.0)
    variance = np.where(there, noise[:, None] * spread[constant] / scale[constant] ** 2, np.inf)
    return gain, variance


def _inverse_diagonal(columns: np.ndarray) -> np.ndarray:
    """The diagonal of the inverse of AᴴA; very large where it has no inverse, as inputs that move alike have none.

    By the singular values of A, as those of AᴴA are squares: below a millionth of the largest they would be rounding.
    """
    _, values, vectors = np.linalg.svd(columns, full_matrices=False)
    values = np.maximum(values, FLAT * max(float(values[0]), 1e-300))
    return (np.abs(vectors.T) ** 2) @ values**-2.0
