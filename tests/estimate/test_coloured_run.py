"""Errors that are coloured, weighed by their spectrum: against white ones, against least squares, against what scatters in repeats."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.estimate.coloured_run import ColouredRun, fit_coloured, spectrum, transformed
from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.levenberg_marquardt import minimise
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.uncertainty import of_information
from greybox_torch.simulation.simulator import Simulator

from ..machines.motor import Motor

TRUE = {"J": 0.02, "k": 0.1, "b": 0.05}
SAMPLES = 1500


@pytest.fixture(scope="module")
def run_of(data_set, motor_speed):
    """The motor at its true values, with noise of 0.02 rad/s and a voltage beside the recorded one that drifts slowly."""

    def make(seed: int, drift: float, missing: int = 0) -> FreeRun:
        rng = np.random.default_rng(seed)
        voltage = np.repeat(rng.uniform(-3, 3, SAMPLES // 20), 20)
        time = 0.01 * np.arange(SAMPLES)
        slow = drift * np.sin(2 * np.pi * time / rng.uniform(4, 12) + rng.uniform(0, 6))
        speed = motor_speed(voltage + slow) + rng.normal(0, 0.02, SAMPLES)
        speed[200 : 200 + missing] = np.nan
        data = data_set({"voltage": "V", "speed": "rad/s"}, [{"voltage": voltage, "speed": speed}], sample_time=0.01)
        problem = make_problem(data, Motor(), data.recordings, values=TRUE)
        return FreeRun(problem, Simulator.of(problem.model, problem.free_names))

    return make


def away(run: FreeRun, z: np.ndarray) -> np.ndarray:
    """Errors of the parameters, relative."""
    true = [TRUE[n] for n in run.problem.free_names]
    return z[: run.n_parameters] / true - 1.0


def test_the_transform_keeps_energy_and_the_spectrum_of_white_noise_is_flat() -> None:
    noise = np.random.default_rng(0).normal(0, [0.3, 2.0], (20_000, 2))
    np.testing.assert_allclose((transformed(noise) ** 2).sum(axis=0), (noise**2).sum(axis=0), rtol=1e-12)
    sizes = spectrum(noise)
    assert sizes[100:] / [0.3, 2.0] == pytest.approx(np.ones((19_900, 2)), abs=0.3)
    assert np.sqrt((sizes**2).mean(axis=0)) == pytest.approx([0.3, 2.0], rel=0.02)


def test_what_is_slow_is_large_at_low_frequencies_alone() -> None:
    noise = np.random.default_rng(0).normal(0, 0.1, (4000, 1))
    sizes = spectrum(noise + np.sin(np.linspace(0, 7, 4000))[:, None])
    assert sizes[:5].min() > 5.0 and sizes[100:].max() < 0.15
    assert spectrum(np.zeros((50, 1))).min() > 0.0


def unlikely(run: FreeRun, z: np.ndarray) -> float:
    """Negative logarithm of the likelihood of the errors at ``z`` with their own spectrum, but for a constant."""
    found = [errors for errors, _ in run.errors(z) or []]
    sizes = [spectrum(errors) for errors in found]
    return sum(np.log(s).sum() + 0.5 * ((transformed(e) / s) ** 2).sum() for e, s in zip(found, sizes, strict=True))


def test_gradient_and_curvature_are_those_of_the_cost(run_of) -> None:
    run = run_of(0, 0.02, missing=30)
    found = run.errors(run.start)
    weighed = ColouredRun(run, tuple(spectrum(errors) for errors, _ in found))
    z = run.start * 1.001
    here = weighed.quadratic(z)
    step = 1e-6 * np.maximum(np.abs(z), 1e-3)
    slopes = []
    for k in range(len(z)):
        moved = np.zeros(len(z))
        moved[k] = step[k]
        there, back = weighed.quadratic(z + moved), weighed.quadratic(z - moved)
        slopes.append((there.cost - back.cost) / (2 * step[k]))
        curved = (there.gradient - back.gradient) / (2 * step[k])  # the Gauss-Newton part of it
        assert curved[k] == pytest.approx(here.hessian[k, k], rel=0.05)
    assert here.gradient == pytest.approx(np.array(slopes), rel=1e-4)
    assert here.extra == pytest.approx(unlikely(run, z))


def test_white_errors_are_weighed_alike(run_of) -> None:
    """Then least squares is the likelihood, and the two differ by much less than either varies."""
    run = run_of(3, 0.0)
    plain, found = minimise(run.quadratic, run.start, *run.bounds), fit_coloured(run, run.start)
    assert found is not None and plain is not None
    deviations = of_information(found.information).deviations()
    assert (np.abs(found.point - plain.point) < 0.5 * deviations).all()


def test_drift_does_not_bend_the_parameters(run_of) -> None:
    """Over repeats: nearer to the truth than least squares by a factor, by deviations that say how near."""
    plain, weighed, scores = [], [], []
    for seed in range(12):
        run = run_of(seed, 0.2)
        best, found = minimise(run.quadratic, run.start, *run.bounds), fit_coloured(run, run.start * 1.05)
        assert best is not None and found is not None
        plain.append(away(run, best.point))
        weighed.append(away(run, found.point))
        deviations = of_information(found.information).deviations()[: run.n_parameters]
        scores.append((found.point - run.start)[: run.n_parameters] / deviations)
    assert np.sqrt(np.mean(np.square(weighed))) < 0.5 * np.sqrt(np.mean(np.square(plain)))
    assert 0.5 < np.sqrt(np.mean(np.square(scores))) < 2.0


def test_more_likely_is_cheaper_and_what_cannot_be_simulated_is_none(run_of) -> None:
    run = run_of(1, 0.2)
    found = fit_coloured(run, run.start)
    assert found is not None and found.cost < unlikely(run, run.start * 1.2)
    assert fit_coloured(run, np.full_like(run.start, np.nan)) is None
