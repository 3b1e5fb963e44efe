"""The free run where what is left is coloured: errors weighed at every frequency by how large they are there.

Slow disturbances that no model holds (a drift of the load, of an amplifier) make the errors of a free run large at low frequencies. Least
squares takes all errors for white and bends the parameters to what is slow; the likelihood of coloured errors does not. Errors and
sensitivities are transformed by the discrete cosine transform, which nearly decorrelates stationary errors, and divided by the standard
deviation of the errors at each frequency, taken from the errors themselves.

Source: P. Whittle, "Estimation and information in stationary time series", Arkiv för Matematik 2, 1953; L. Ljung, "System Identification:
Theory for the User", 2nd ed., section 7.4 (likelihood) and 8.5 (what a noise model does to the bias).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.fft import dct

from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.levenberg_marquardt import Quadratic, Settings, minimise

WIDTH, LEAST_WIDTH = 1.3, 4
"""The spectrum at frequency k is the mean over those from k / WIDTH − LEAST_WIDTH to k · WIDTH + LEAST_WIDTH."""

ROUNDS = 8
"""How often the spectrum is taken anew, at most."""

STEPS = Settings(iterations=5, tolerance=1e-5)
"""Of a round: the spectrum changes before its optimum is reached."""

STILL = 0.1
"""Change of the logarithm of the likelihood that counts as none."""


@dataclass(frozen=True)
class Coloured:
    """A free run fitted with coloured errors: the unknowns z (d,), the negative logarithm of the likelihood, the information (d, d)."""

    point: np.ndarray
    cost: float
    information: np.ndarray


@dataclass(frozen=True)
class ColouredRun:
    """A free run whose errors have the deviations ``sizes`` [e] (N_e, n_y) at the frequencies of each experiment e."""

    run: FreeRun
    sizes: tuple[np.ndarray, ...]

    def quadratic(self, z: np.ndarray) -> Quadratic[float] | None:
        """Cost, gradient and Gauss-Newton Hessian at ``z``, and the negative logarithm of the likelihood with the spectrum that the errors
        have there; None where the simulation is not finite.
        """
        found = self.run.errors(z)
        if found is None:
            return None
        frequencies, matrices = [transformed(errors) for errors, _ in found], []
        for own, (_, slopes), sizes in zip(frequencies, found, self.sizes, strict=True):
            columns = np.concatenate([transformed(slopes), own[..., None]], axis=2) / sizes[..., None]
            rows = columns.reshape(own.size, -1)
            matrices.append(rows.T @ rows)
        return self.run.assembled(matrices, _cost(frequencies))


def fit_coloured(run: FreeRun, start: np.ndarray) -> Coloured | None:
    """Estimate the unknowns of ``run`` from ``start`` (d,), errors and their spectrum in turns; None where the simulation is not finite."""
    point, best = start, None
    for _ in range(ROUNDS):
        found = run.errors(point)
        if found is None:
            break
        weighed = ColouredRun(run, tuple(spectrum(errors) for errors, _ in found))
        ended = minimise(weighed.quadratic, point, *run.bounds, settings=STEPS, admissible=run.admissible)
        if ended is None:
            break
        point, before = ended.point, np.inf if best is None else best.cost
        if ended.model.extra < before:
            best = Coloured(point, ended.model.extra, ended.model.hessian)
        if ended.model.extra > before - STILL:
            break
    return best


def transformed(signals: np.ndarray) -> np.ndarray:
    """Cosine transform of ``signals`` (N, …) along time, of the same energy."""
    return np.asarray(dct(signals, axis=0, norm="ortho"))


def spectrum(errors: np.ndarray) -> np.ndarray:
    """Standard deviation (N, n_y) at every frequency of ``errors`` (N, n_y), smoothed over neighbours."""
    return _smoothed(transformed(errors))


def _smoothed(frequencies: np.ndarray) -> np.ndarray:
    """Root mean square (N, n_y) of the transform (N, n_y) over neighbouring frequencies."""
    power, count = frequencies**2, len(frequencies)
    k = np.arange(count)
    low = np.maximum(np.floor(k / WIDTH).astype(int) - LEAST_WIDTH, 0)
    high = np.minimum(np.ceil(k * WIDTH).astype(int) + LEAST_WIDTH, count - 1)
    sums = np.concatenate([np.zeros((1, power.shape[1])), np.cumsum(power, axis=0)])
    mean = (sums[high + 1] - sums[low]) / (high + 1 - low)[:, None]
    return np.sqrt(np.maximum(mean, 1e-12 * mean.max(axis=0) + 1e-300))


def _cost(frequencies: Sequence[np.ndarray]) -> float:
    """Negative logarithm of the likelihood, but for a constant, of errors with these transforms [e] (N_e, n_y) and their own spectrum."""
    total = 0.0
    for own in frequencies:
        sizes = _smoothed(own)
        total += float(np.log(sizes).sum() + 0.5 * ((own / sizes) ** 2).sum())
    return total
