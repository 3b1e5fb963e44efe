from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from greybox_torch.estimate.frequency_response import frequency_response

STEP = 0.01
POLE = 0.9


@pytest.fixture
def rng() -> np.random.Generator:
    """The same draws for every test, whatever ran before in its process."""
    return np.random.default_rng(5)


def lag(u: np.ndarray, start: float = 0.0) -> np.ndarray:
    """y(t) = 0.9 y(t − 1) + 0.1 u(t − 1)."""
    return lfilter([0.0, 1.0 - POLE], [1.0, -POLE], u, zi=[start])[0]


def of_lag(frequency: np.ndarray) -> np.ndarray:
    z = np.exp(2j * np.pi * frequency * STEP)
    return (1.0 - POLE) / (z - POLE)


def test_the_region_holds_the_true_response() -> None:
    """A circle of √−ln 0.05 standard deviations holds 95 % of the estimates; neighbours share their lines, so that fewer count."""
    inside = []
    for seed in range(6):
        rng = np.random.default_rng(seed)
        u = rng.normal(size=4000)
        y = lag(u, start=20.0) + 0.05 * rng.normal(size=4000)  # begins far away: a transient
        found = frequency_response([u[None]], [y[None]], STEP)
        assert found is not None
        away = np.abs(found.gain[0, 0] - of_lag(found.frequency))
        inside.append(np.mean(away < np.sqrt(-np.log(0.05) * found.variance[0, 0])))
        assert np.median(away / np.abs(found.gain[0, 0])) < 0.15
    assert 0.9 < np.mean(inside) < 0.99


def test_records_are_taken_together(rng: np.random.Generator) -> None:
    """With four records a frequency has four times the lines, and half the standard deviation."""
    u = rng.normal(size=(4, 1, 2000))
    y = np.array([lag(one[0], start=float(k)) + 0.05 * rng.normal(size=2000) for k, one in enumerate(u)])[:, None]
    alone, together = frequency_response(list(u[:1]), list(y[:1]), STEP), frequency_response(list(u), list(y), STEP)
    assert alone is not None and together is not None
    same = np.interp(together.frequency, alone.frequency, np.sqrt(alone.variance[0, 0]))
    assert np.median(np.sqrt(together.variance[0, 0]) / same) == pytest.approx(0.5, rel=0.2)


def test_two_inputs_and_two_outputs(rng: np.random.Generator) -> None:
    u = rng.normal(size=(2, 6000))
    y = np.stack([lag(u[0]) + 3.0 * u[1], -2.0 * u[0]])
    found = frequency_response([u], [y], STEP)
    assert found is not None
    assert np.abs(found.gain[0, 0] - of_lag(found.frequency)).max() < 1e-2
    assert found.gain[0, 1] == pytest.approx(np.full(len(found.frequency), 3.0), abs=1e-2)
    assert found.gain[1, 0] == pytest.approx(np.full(len(found.frequency), -2.0), abs=1e-9)
    assert found.outputs[1] == pytest.approx(4.0 * found.inputs[0])


def test_what_is_not_excited_is_not_known(rng: np.random.Generator) -> None:
    """An input at rest, and two that move alike: the variance says so, and nothing is made up."""
    u = rng.normal(size=4000)
    resting = frequency_response([np.stack([u, np.zeros(4000)])], [lag(u)[None]], STEP)
    assert resting is not None and np.isinf(resting.variance[0, 1]).all()
    alike = frequency_response([np.stack([u, u])], [(lag(u) + 0.01 * rng.normal(size=4000))[None]], STEP)
    assert alike is not None and (np.sqrt(alike.variance) > 10.0 * np.abs(alike.gain)).all()


def test_frequencies_without_input_power(rng: np.random.Generator) -> None:
    """A sum of sines leaves most lines without power: there the deviation is as large as the response."""
    time = STEP * np.arange(4000)
    phases = rng.uniform(
        0.0, 2.0 * np.pi, size=180
    )  # one that rises with the frequency makes a single pulse of the sum
    u = np.sum(
        [np.sin(2 * np.pi * f * time + p) for f, p in zip(np.arange(0.5, 5.0, 0.025), phases, strict=True)], axis=0
    )
    found = frequency_response([u[None]], [(lag(u) + 0.001 * rng.normal(size=4000))[None]], STEP)
    assert found is not None
    uncertain = np.sqrt(found.variance[0, 0]) / np.abs(found.gain[0, 0])
    assert (uncertain[found.frequency > 8.0] > 0.5).all()
    within = (found.frequency > 1.0) & (found.frequency < 4.0)
    assert (uncertain[within] < 0.05).all()


@pytest.mark.parametrize("noise", [0.0, 1e-9, 1e-3])
def test_where_the_input_has_nothing_but_the_ends_of_its_record(noise: float, rng: np.random.Generator) -> None:
    """Five sines up to 5 Hz, cut off: their lines at 8 Hz and above are smooth, as the transient is, and show no response.

    Seen: a press, of which the report drew 1e6 m/V from 8 to 220 Hz, "the radius of its 95 % region is 2 %".
    """
    time = 0.2 * STEP * np.arange(4000)
    u = np.sum([np.sin(2 * np.pi * f * time + f) for f in (0.3, 0.7, 1.3, 2.9, 5.1)], axis=0)
    bent = np.sign(u) * np.maximum(np.abs(u) - 0.35, 0.0)  # a dead band has harmonics where the input has nothing
    y = np.stack([lag(u), lag(lag(bent))]) + noise * rng.normal(size=(2, 4000))
    found = frequency_response([u[None]], [y], 0.2 * STEP)
    assert found is not None
    certain = 2.0 * np.sqrt(found.variance[:, 0]) < np.abs(found.gain[:, 0])
    assert certain[0, found.frequency < 1.5].all()
    assert not certain[:, found.frequency > 8.0].any()


def test_power_without_leakage(rng: np.random.Generator) -> None:
    """A slow drift a thousand times as large as the rest leaves the power at high frequencies what it is."""
    time = STEP * np.arange(8000)
    u = rng.normal(size=8000)
    found = frequency_response([(u + 1000.0 * time / time[-1])[None]], [u[None]], STEP)
    assert found is not None
    high = found.frequency > 10.0
    assert np.mean(found.inputs[0][high]) == pytest.approx(1.0, rel=0.15)


@pytest.mark.parametrize("samples", [0, 1, 8, 18])
def test_a_record_too_short(samples: int, rng: np.random.Generator) -> None:
    u = rng.normal(size=(1, samples))
    assert frequency_response([u], [u], STEP) is None


def test_no_records() -> None:
    assert frequency_response([], [], STEP) is None
