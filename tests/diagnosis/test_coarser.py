"""Recordings that are sampled faster than the machine moves are searched with fewer samples, and judged by all."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some

import greybox_torch as gt
from greybox_torch.diagnosis.coarser import Coarser, coarser, sampled
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.estimate.simulators import simulator_for

SAMPLES, NOISE = 6000, 0.02
Recorded = Callable[..., gt.DataSet]


Held = some.tuples(some.floats(-5, 5), some.floats(0.5, 1.5))
"""A value, and for how long it is held."""


@given(some.integers(2, 9), some.lists(Held, min_size=40, max_size=80))
def test_a_held_input_moves_an_integrator_as_before(every, held) -> None:
    """From one sample to the next, the integral of the input is that of its mean, also where samples are not as far apart."""
    voltage, steps = np.array([*held[:-1], (held[-1][0], 1.0)]).T
    time = np.concatenate([[0.0], np.cumsum(steps)])
    integral = np.concatenate([[0.0], np.cumsum(voltage * steps)])
    recording = gt.Recording.from_arrays("one", {"u": voltage, "y": integral[:-1]}, sample_time=1.0)
    data = gt.DataSet([replace(recording, time=time[:-1])], held_out_by_default=False)
    found = sampled(data, every, ["u"]).recordings[0]
    at = every * np.arange(len(held) // every)
    assert np.array_equal(found.time, time[at]) and np.array_equal(found.signals["y"], integral[at])
    assert np.allclose(integral[at + every] - integral[at], (time[at + every] - time[at]) * found.signals["u"])
    assert found.sample_time == every


def test_straight_lines_between_samples_stay_straight_lines() -> None:
    ramp = np.arange(60.0)
    data = gt.DataSet(
        [gt.Recording.from_arrays("ramp", {"u": ramp, "y": ramp}, sample_time=0.5)],
        hold="foh",
        held_out_by_default=False,
    )
    found = sampled(data, 4, ["u"]).recordings[0]
    assert np.allclose(found.signals["u"], 2.0 * found.time)
    assert found.sample_time == 2.0


@pytest.fixture(scope="module")
def recorded(data_set, motor_speed) -> Recorded:
    """Slow swings of the voltage of ``period`` samples, the speed with white noise."""

    def make(period: float = 800.0, noise: float = NOISE, **of: object) -> gt.DataSet:
        time, draw, experiments = np.arange(SAMPLES), np.random.default_rng(1), []
        for phase in (0.0, 1.0):
            voltage = 3.0 * np.sin(2 * np.pi * time / period + phase) + np.sin(2 * np.pi * time / (2.7 * period))
            speed = motor_speed(voltage, start=0.0) + noise * draw.normal(size=SAMPLES)
            experiments.append({"voltage": voltage, "speed": speed})
        return data_set(
            {"voltage": "V", "speed": "rad/s"}, experiments, roles=["estimation", "validation"], sample_time=0.01, **of
        )

    return make


def searched(
    data: gt.DataSet, motor: gt.GreyBoxModel, least: int = 1000, most: int = 9, left: float | None = None
) -> Coarser:
    def problem_of(these: gt.DataSet) -> Problem:
        return make_problem(these, motor, these.estimation())

    problem = problem_of(data)
    budget = gt.SearchBudget(least_samples=least, most_passed_over=most)
    squared = None if left is None else lambda: np.array([left**2])
    return coarser(data, problem, simulator_for(problem), problem_of, gt.DiagnosisSettings(), budget, squared)


def test_as_many_samples_are_passed_over_as_show_nothing_but_noise(recorded, motor) -> None:
    slow, faster = searched(recorded(), motor), searched(recorded(period=40.0, noise=1e-3), motor)
    assert [len(r) for r in slow.dataset.recordings] == 2 * [SAMPLES // 6]
    assert slow.problem.records.y.shape[1] == SAMPLES // 6
    assert slow.sentences[0].startswith("The search used one of 6 samples, 0.06 s apart")
    assert faster.sentences == ()


def test_samples_that_are_not_as_far_apart_are_passed_over_as_well(recorded, motor) -> None:
    data = recorded()
    late = [replace(r, time=r.time + 0.002 * (np.arange(SAMPLES) % 2)) for r in data.recordings]
    found = searched(replace(data, recordings=tuple(late)), motor)
    assert [len(r) for r in found.dataset.recordings] == 2 * [SAMPLES // 6]


def test_where_the_noise_is_not_known_what_the_model_leaves_says_how_many(recorded, motor) -> None:
    """An encoder of fine resolution: what is between its samples is motion, of which a large error is no part."""
    data = recorded(period=200.0, noise=0.0)
    assert searched(data, motor).sentences == ()
    found = {left: len(searched(data, motor, left=left).dataset.recordings[0]) for left in (1e-4, 0.02, 100.0)}
    assert found[1e-4] == SAMPLES > found[0.02] > found[100.0]
    told = searched(data, motor, left=100.0).sentences[0]
    assert "next to nothing of what the model leaves is between them" in told


@pytest.mark.parametrize("why", ["short", "no noise", "all wanted"])
def test_recordings_stay_as_they_are(recorded, motor, why) -> None:
    data = recorded(noise=0.0) if why == "no noise" else recorded()
    found = searched(data, motor, 4000 if why == "short" else 1000, 0 if why == "all wanted" else 9)
    assert found.dataset is data
    assert found.sentences == ()


def test_the_law_is_found_and_the_verdict_is_of_all_samples(recorded, motor) -> None:
    data = recorded()
    dead = [
        replace(r, signals={**r.signals, "voltage": r.signals["voltage"] + 0.5 * np.sign(r.signals["voltage"])})
        for r in data.recordings
    ]
    budget = gt.SearchBudget(most_effects=1, least_samples=1000)
    verdict = gt.diagnose(motor, replace(data, recordings=tuple(dead)), budget=budget).verdict
    (found,) = verdict.effects
    assert (found.port, found.mechanism) == ("actuator", "actuator_deadzone")
    assert [p["value"] for p in found.parameters.values()] == pytest.approx([0.5], rel=0.02)
    assert {t.measured.size for t in verdict.traces} == {SAMPLES}
    assert any("one of 6 samples" in told for told in verdict.evidence)
