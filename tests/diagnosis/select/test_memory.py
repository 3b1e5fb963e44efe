"""Where laws and curves leave much more than noise, it is asked whether what is missing remembers; and only there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.describe.effects import ceiling_share
from greybox_torch.diagnosis.describe.memory import remembered, settled_curve
from greybox_torch.diagnosis.hypothesis.above_noise import times_noise
from greybox_torch.diagnosis.hypothesis.final import finish
from greybox_torch.diagnosis.refit.refitted import refitted
from greybox_torch.diagnosis.screen.candidates import memory_candidates
from greybox_torch.diagnosis.select import memory
from greybox_torch.diagnosis.select.memory import with_memory
from greybox_torch.diagnosis.select.offered import memory_scores, place
from greybox_torch.diagnosis.select.state import SearchState, SelectionStep
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.friction import ViscousFriction
from greybox_torch.mechanisms.unknown_with_memory import UnknownWithMemory
from greybox_torch.model import Body
from tests.diagnosis.conftest import STEP, Begun

DRAG, T = 0.15, 0.2


@pytest.fixture(scope="module")
def dragged(data_set, motor, begun) -> Begun:
    """The motor with a drag that follows its speed late: 0.15 N m s/rad, by 0.2 s."""
    rng, samples = np.random.default_rng(5), 600
    voltage = np.repeat(rng.uniform(-3, 3, samples // 20), 20)
    x, speeds, fine = np.zeros(2), [], 8
    for v in voltage:
        speeds.append(x[0])
        for _ in range(fine):  # by Heun's steps
            k1 = _rates(x, v)
            x = x + 0.5 * STEP / fine * (k1 + _rates(x + STEP / fine * k1, v))
    noisy = np.array(speeds) + rng.normal(0, 0.005, samples)
    return begun(
        data_set({"voltage": "V", "speed": "rad/s"}, [{"voltage": voltage, "speed": noisy}], sample_time=STEP), motor
    )


def _rates(x: np.ndarray, v: float) -> np.ndarray:
    return np.array([(0.1 * v - 0.05 * x[0] - DRAG * x[1]) / 0.02, (x[0] - x[1]) / T])


@pytest.fixture(scope="module")
def found(dragged: Begun) -> SearchState:
    return result_of(with_memory(dragged.study, dragged.state))


def test_a_drag_that_comes_late_is_found_at_its_port(dragged: Begun, found: SearchState) -> None:
    (effect,) = found.effects
    assert isinstance(effect.mechanism, UnknownWithMemory)
    assert (effect.port, effect.mechanism.signal, effect.mechanism.modes) == ("rotor", "speed", 1)
    assert times_noise(dragged.problem, found.current, dragged.study.settings) < 1.3
    assert found.has_curve


def test_its_response_lies_within_its_band(dragged: Begun, found: SearchState) -> None:
    final = finish(found.current)
    told = remembered(found.effects[0], dragged.surroundings["rotor"], final, "speed")
    assert told is not None and told.deviation is not None
    assert told.seconds == pytest.approx(T, abs=5 * told.deviation) and told.deviation < 0.05 * T
    # The model's own friction may take the gain without memory: what is certain is how the response changes with frequency.
    along = 2j * np.pi * told.frequency
    change, true = np.diff(told.gain), np.diff(-DRAG / (1 + along * T))
    assert np.abs(change - true).max() < 5 * told.spread.max() < 0.2 * DRAG
    assert told.as_json()["response"]["gain"][0] == pytest.approx(DRAG, rel=0.1)
    settled = settled_curve(found.effects[0], dragged.surroundings["rotor"], final)
    assert settled is not None and settled.unit == "rad/s"
    np.testing.assert_allclose(settled.force, told.gain[0].real * settled.values, rtol=0.05, atol=1e-3)


def test_nothing_is_computed_where_an_effect_leaves_noise(
    dragged: Begun, found: SearchState, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(memory, "memory_scores", lambda *_: pytest.fail("asked for nothing"))
    assert result_of(with_memory(dragged.study, found)) is found


@pytest.fixture(scope="module")
def named(dragged: Begun) -> SearchState:
    """Plain friction in its place, which leaves much more than noise."""
    fitted = refitted(dragged.study, [attach(dragged.problem.model, "rotor", ViscousFriction())], dragged.plain)
    assert fitted is not None
    return dragged.state.at(fitted)


def test_it_takes_the_place_of_a_name_that_leaves_more(
    dragged: Begun, found: SearchState, named: SearchState, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The name is kept at hand, for held-out experiments to prefer it; so is one that had its place before, of a curve."""
    monkeypatch.setattr(memory, "linear_residual", lambda study, state, *rest: replace(found, named=None))
    for standing, names in ((named, named), (replace(named, named=dragged.state), dragged.state)):
        instead = result_of(with_memory(dragged.study, standing))
        assert instead.effects == found.effects and instead.memory is not None
        assert instead.named is not None and instead.named.effects == names.effects


def test_where_it_comes_little_farther_the_name_stands_and_it_is_the_ceiling(
    dragged: Begun, found: SearchState, named: SearchState, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(memory, "linear_residual", lambda study, state, *rest: state if state.effects else found)
    monkeypatch.setattr(memory, "_curved_if_farther", lambda study, linear, to_beat: linear)
    strict = replace(dragged.study, settings=replace(dragged.study.settings, curve_margin=50.0))
    kept = result_of(with_memory(strict, named))
    assert kept.effects == named.effects and kept.memory is found
    done = found.steps[-1]
    best = done.ranked[0]
    law = replace(best, candidate=replace(best.candidate, attachment=named.effects[0]), gain=1.0)
    step = replace(done, taken=law, ranked=(law,))
    assert ceiling_share(step) is None and ceiling_share(step, kept.memory_step) == pytest.approx(
        1.0 / best.gain, abs=1e-3
    )


def test_beside_others_it_is_not_polished_from_far_above_the_noise(
    dragged: Begun, found: SearchState, named: SearchState, monkeypatch: pytest.MonkeyPatch
) -> None:
    """There it has to complete the model. Seen: 7 of the 80 s of the robot arm's diagnosis, and no further."""
    far = replace(found.steps[-1].ranked[0], fitted=named.current)
    monkeypatch.setattr(memory, "rank", lambda *_: [far])
    monkeypatch.setattr(memory, "take_best", lambda *_: pytest.fail("polished"))
    beside = memory.linear_residual(dragged.study, named, named)
    assert beside.steps[-1].ranked == (far,) and not beside.took_one and beside.current is named.current


def test_no_position_is_integrated_for_it(dragged: Begun) -> None:
    """The motor's rotor has no position of its own: where it began would not be known."""
    body = next(p for p in dragged.problem.model.ports if isinstance(p, Body))
    assert body.position is None
    offered = memory_candidates(dragged.problem.model, dragged.surroundings)
    signals = {(a.port, a.mechanism.signal) for a in offered if isinstance(a.mechanism, UnknownWithMemory)}
    assert signals == {("rotor", "speed"), ("actuator", "input")}


def test_curves_in_front_are_screened_where_residuals_without_explain_most(dragged: Begun) -> None:
    """Seen: 41 of 109 s for curves at all thirteen ports of half a car, with nothing missing but white noise."""
    study, state = dragged.study, dragged.state
    linear = memory_scores(study, state)
    first = {place(max(at, key=lambda score: score.explained).attachment) for at in linear}
    step = SelectionStep(linear, state.plain, (), None)
    few = replace(study, budget=replace(study.budget, curves_with_memory=1))
    assert memory._leading(few, replace(state, steps=(step,))) == first == {("rotor", "speed")}
    screened = {place(s.attachment) for at in memory_scores(study, state, study.budget.knots, first) for s in at}
    assert screened == first < {place(s.attachment) for at in linear for s in at}
