"""Long recordings are searched in part, where they move most, and judged as a whole."""

from __future__ import annotations

import numpy as np

import greybox_torch as gt
from greybox_torch.diagnosis.excerpts import excerpts


def recorded(name: str, samples: int, lively: slice, role: str = "estimation") -> gt.Recording:
    """White noise, ten times as large over a part."""
    values = np.random.default_rng(0).normal(size=(2, samples))
    values[:, lively] *= 10.0
    return gt.Recording.from_arrays(name, {"u": values[0], "y": values[1]}, sample_time=0.01, role=role)  # type: ignore[arg-type]


LONG = recorded("long", 20_000, slice(12_000, 15_000))
SHORT = recorded("short", 3_000, slice(0, 3_000), "validation")


def test_the_stretch_that_moves_most_is_taken_of_a_long_recording() -> None:
    used = excerpts(gt.DataSet([LONG, SHORT]), 4_000)
    part, same = used.dataset.recordings
    assert part.name == "long from 110 s"
    assert len(part) == 4_000
    assert part.time[0] <= LONG.time[12_000] < LONG.time[14_999] <= part.time[-1]
    assert part.signals["y"][0] == LONG.signals["y"][11_000]
    assert same is SHORT
    assert used.sentences == (
        "Of long the search used the 4000 samples from 110 s on, where most moves; the free runs are of all 20000.",
    )


def test_nothing_is_taken_away_of_recordings_that_are_short() -> None:
    data = gt.DataSet([LONG, SHORT])
    assert excerpts(data, 20_000).dataset is data


def test_with_start_states_on_the_card_the_stretch_is_the_first() -> None:
    part = excerpts(gt.DataSet([LONG, SHORT], initial={"speed": 0.0}), 4_000).dataset.recordings[0]
    assert part.name == "long"
    assert part.time[0] == LONG.time[0]


def test_recordings_of_one_role_are_shortened_in_proportion() -> None:
    other = recorded("other", 10_000, slice(0, 100))
    parts = excerpts(gt.DataSet([LONG, other, SHORT]), 6_000).dataset.recordings
    assert [len(p) for p in parts] == [4_000, 2_000, 3_000]


def test_a_diagnosis_of_a_long_recording_is_judged_on_all_of_it(motor, motor_data) -> None:
    data = motor_data(samples=4000, acting=lambda v: np.where(np.abs(v) > 0.5, v - np.sign(v) * 0.5, 0.0))
    budget = gt.SearchBudget(most_samples=1500, most_effects=1)
    verdict = gt.diagnose(motor, data, budget=budget).verdict
    assert [e.mechanism for e in verdict.effects] == ["actuator_deadzone"]
    assert {t.measured.size for t in verdict.traces} == {4000}
    assert sum("the search used the 1500 samples" in sentence for sentence in verdict.evidence) == 2
