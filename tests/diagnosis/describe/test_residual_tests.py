"""What the errors give away: correlation with inputs before, colour, feedback."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from greybox_torch.diagnosis.describe.residual_tests import Detection, detect
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.traces import Trace
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.residuals import input_correlation

SAMPLES, STEP = 4000, 0.01


@pytest.fixture
def detected(data_set, motor):
    """The detections for errors before and after (N,) of a motor's speed, under given voltages."""

    def make(*records: tuple[np.ndarray, np.ndarray, np.ndarray], hold="zoh", role="estimation"):
        measured = [np.where(np.isnan(after), np.nan, np.sin(0.01 * np.arange(SAMPLES))) for _, _, after in records]
        pairs = list(zip(records, measured, strict=True))
        signals = [{"voltage": voltage, "speed": y} for (voltage, _, _), y in pairs]
        data = data_set({"voltage": "V", "speed": "rad/s"}, signals, sample_time=STEP, hold=hold)
        problem = make_problem(data, motor, data.recordings)
        traces = [
            Trace(
                f"run {e + 1}",
                role,
                "speed",
                "rad/s",
                problem.records.time(e),
                y,
                y,
                *(np.nan_to_num(y - error, posinf=np.inf) for error in errors),
            )
            for e, ((_, *errors), y) in enumerate(pairs)
        ]
        return detect(problem, traces, DiagnosisSettings())

    return make


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(0)


def white(rng: np.random.Generator, size: float = 0.1) -> np.ndarray:
    return rng.normal(0, size, SAMPLES)


def held(rng: np.random.Generator) -> np.ndarray:
    """A voltage in steps, as an experimenter has it."""
    return np.repeat(rng.uniform(-3, 3, SAMPLES // 20), 20)


def slow(rng: np.random.Generator) -> np.ndarray:
    """A voltage without power above 5 Hz."""
    spectrum = np.fft.rfft(rng.normal(0, 10, SAMPLES))
    spectrum[np.fft.rfftfreq(SAMPLES, STEP) > 5.0] = 0.0
    return np.fft.irfft(spectrum, SAMPLES)


def missing(voltage: np.ndarray) -> np.ndarray:
    """What a first-order lag that the model lacks leaves as an error."""
    return lfilter([0.0, 0.05], [1.0, -0.9], voltage)


def one(found: tuple[Detection, ...]) -> Detection:
    (detection,) = found
    return detection


def test_before_and_after(detected, rng) -> None:
    voltage = held(rng)
    found = one(detected((voltage, white(rng) + missing(voltage), white(rng))))
    assert (found.experiment, found.output) == ("run 1", "speed")
    assert found.plain.past.ratio > 2.0 and found.plain.past.value > 0.3
    assert found.plain.colour.beyond and not found.final.colour.beyond
    assert not found.final.past.beyond and not found.feedback


def test_coloured_errors_are_not_taken_for_correlation_with_the_input(detected, rng) -> None:
    found = one(detected((held(rng), lfilter([1.0], [1.0, -0.95], white(rng)), white(rng))))
    assert found.plain.colour.value == pytest.approx(0.95, abs=0.03) and found.plain.colour.beyond
    assert not found.plain.past.beyond


def test_nothing_is_seen_where_nothing_is(detected) -> None:
    """The bounds hold for all lags of all experiments together."""
    alarms = 0
    for seed in range(20):
        rng = np.random.default_rng(seed)
        records = [(held(rng), white(rng), white(rng)) for _ in range(3)]
        found = detected(*records)
        alarms += any(d.plain.past.beyond or d.plain.colour.beyond or d.feedback for d in found)
    assert alarms <= 1


@pytest.mark.parametrize("delay", [0, 1, 3])
def test_noise_that_is_fed_back(detected, rng, delay) -> None:
    """Coloured noise comes back through the controller: it is coherent with the input, and yet no physics is missing."""
    wanted, noise = slow(rng), lfilter([1.0], [1.0, 0.0, 0.0, 0.0, -0.8], white(rng, 0.15))
    voltage = wanted + np.roll(noise, delay)
    assert input_correlation(noise, voltage).outside > 0
    found = one(detected((voltage, noise, noise)))
    assert found.feedback
    assert 4.0 < found.band < 6.0
    assert not found.plain.past.beyond


def test_physics_that_is_missing_is_seen_under_feedback_as_well(detected, rng) -> None:
    wanted, noise = slow(rng), white(rng, 0.02)
    voltage = wanted + np.roll(noise, 1)
    found = one(detected((voltage, missing(wanted) + noise, noise)))
    assert found.feedback and found.plain.past.beyond and not found.final.past.beyond


def test_feedback_in_one_of_two_recordings(detected, rng) -> None:
    noise = white(rng)
    first, second = detected((held(rng), noise, noise), (slow(rng) + np.roll(noise, 1), noise, noise))
    assert (first.feedback, second.feedback) == (False, True)


def test_at_the_same_sample_only_where_the_input_cannot_be_the_cause(detected, rng) -> None:
    noise = white(rng)
    record = (white(rng, 1.0) + noise, noise, noise)
    assert one(detected(record)).feedback
    assert not one(detected(record, hold="foh")).feedback


def test_gaps(detected, rng) -> None:
    voltage, noise = held(rng), white(rng)
    noise[rng.random(SAMPLES) < 0.01] = np.nan
    found = one(detected((voltage, missing(voltage) + noise, noise)))
    assert found.plain.past.beyond and not found.final.past.beyond and not found.feedback


def test_validation_and_runs_that_went_astray_are_left_out(detected, rng) -> None:
    voltage, noise = held(rng), white(rng)
    assert detected((voltage, noise, noise), role="validation") == ()
    assert detected((voltage, noise, 1e9 * noise)) == ()
    assert detected((voltage, np.where(noise > 0, -np.inf, noise), noise)) == ()
