"""What acts so slowly that only free runs show it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm import longer_windows as module
from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.confirm.longer_windows import (
    constant_effect,
    explains_free_runs,
    longer_windows,
    sentence,
    stands,
)
from greybox_torch.diagnosis.pipeline import diagnose
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.surroundings import Range
from greybox_torch.systems.load import load_model

ROLES = ["estimation", "validation"]
SETTINGS = DiagnosisSettings()
QUICK = SearchBudget(
    most_effects=1,
    most_revisions=0,
    named_per_length=2,
    most_screen_ties=4,
    curves_per_length=0,
    from_motion=0,
    finalists=1,
)


def test_a_weak_constant_force_is_found_over_longer_windows(sled_run, machines) -> None:
    """Over a quarter of a record start states take up all of it but 15 % of the noise."""
    pushed = sled_run(lambda q, v: 1e-4 + 0.0 * q, experiments=2, roles=ROLES)
    verdict = diagnose(pushed, load_model(f"{machines / 'sled.py'}:Sled"), budget=QUICK).verdict
    (effect,) = verdict.effects
    members = effect.one_of.members if effect.one_of is not None else (effect,)
    assert {m.mechanism for m in members} & {"constant_bias", "input_bias"}
    assert any("which windows of up to 1024 samples do not show" in line for line in verdict.evidence)
    assert verdict.left is not None and verdict.left.times_noise == pytest.approx(1.0, abs=0.1)


def test_disturbances_that_add_up_are_no_law(sled_run, machines) -> None:
    """White forces move a free mass ever farther from the model, on every record another way."""
    rng = np.random.default_rng(1)
    shaken = sled_run(lambda q, v: rng.normal(0, 1e-2, len(q)), experiments=2, roles=ROLES, samples=1600)
    verdict = diagnose(shaken, load_model(f"{machines / 'sled.py'}:Sled"), budget=QUICK).verdict
    assert not verdict.mismatch and not verdict.effects
    assert any("what acts slowly was looked for" in line for line in verdict.evidence)


@pytest.fixture(autouse=True)
def hardly(monkeypatch) -> list[bool]:
    """Whether free runs hardly follow without effects; by default they do follow."""
    asked = [False]
    monkeypatch.setattr(module, "hardly_followed", lambda judged: asked[0])
    return asked


def judgement(
    stub, share: float = 1.0, times: float = 10.0, *, plain: float = 1e3, spread: float = 0.1, **errors: float
) -> Any:
    """Free runs that leave ``errors`` by experiment; of the model as it stands, ``plain`` in each."""
    return stub(
        left=lambda effects: (share, times, "run 2"),
        mismatch_share=spread,
        judges=set(errors),
        unstable=frozenset(),
        mismatch=lambda effects, among=None: sum(errors[name] if effects else plain for name in among or errors),
    )


@pytest.mark.parametrize(
    ("share", "times", "by_windows", "before", "lengths", "searched"),
    [
        (1.0, 10.0, 1.1, 1.1, 2, True),
        (1.0, 2.9, 1.1, 1.1, 2, False),
        (0.2, 10.0, 1.1, 1.1, 2, False),
        (1.0, 10.0, 1.4, 1.4, 2, False),
        (1.0, 10.0, 18.0, 1.1, 2, True),
        (1.0, 10.0, 1.1, 1.1, 1, False),
        (1.0, np.nan, 1.1, 1.1, 2, False),
    ],
)
def test_longer_windows_are_searched_where_free_runs_alone_show_more_than_noise(
    monkeypatch, stub, share, times, by_windows, before, lengths, searched
) -> None:
    """``before``: of what the search came to. Seen: a delay, right and alone at the noise, taken back for a slow weight beside it."""
    budget = SearchBudget()
    three = [10, 40, 160]
    lengths_of = {budget.window_factors: three, (*budget.window_factors, 32): [*three, 320][: 2 + lengths]}
    monkeypatch.setattr(module, "window_lengths", lambda problem, budget: lengths_of[budget.window_factors])
    monkeypatch.setattr(module, "times_noise", lambda problem, fitted, settings: fitted)
    study = stub(settings=SETTINGS, budget=budget, problem=stub())
    longer = longer_windows(study, stub(effects=(), current=by_windows), judgement(stub, share, times), before)
    assert (longer is not None) is searched
    assert longer is None or longer.window_factors == (1, 4, 16, 32)


@pytest.mark.parametrize(("times", "spread", "searched"), [(6.0, 0.003, False), (6.0, 0.1, True), (12.0, 0.003, True)])
def test_not_where_disturbances_may_leave_it_and_nobody_sees_it(monkeypatch, stub, times, spread, searched) -> None:
    monkeypatch.setattr(module, "times_noise", lambda problem, fitted, settings: 1.1)
    problem = stub(records=stub(lengths=np.array([4096])))
    study, fitted = stub(settings=SETTINGS, budget=SearchBudget(), problem=problem), stub()
    runs = judgement(stub, times=times, spread=spread)
    assert (longer_windows(study, stub(effects=(), current=fitted), runs, fitted) is not None) is searched


def test_short_records_have_longer_windows_too(monkeypatch, stub) -> None:
    """Of 601 samples: 20 and 80, not 320; then 160. Seen: a clamp's uptake of glucose that saturates, of which 80 show too little."""
    monkeypatch.setattr(module, "times_noise", lambda problem, fitted, settings: 1.1)

    def factors(samples: int) -> tuple[int, ...] | None:
        problem = stub(records=stub(lengths=np.array([samples])))
        study, fitted = stub(settings=SETTINGS, budget=SearchBudget(), problem=problem), stub()
        longer = longer_windows(study, stub(effects=(), current=fitted), judgement(stub), fitted)
        return None if longer is None else longer.window_factors

    assert factors(601) == (1, 4, 8) and factors(4096) == (1, 4, 16, 32)
    assert factors(300) is None, "nothing is longer than 80 and as long as half of it"


def test_windows_of_half_a_record_where_free_runs_hardly_follow(monkeypatch, stub, hardly) -> None:
    """Seen: a crane's trolley, recorded 120 samples at a time: windows of 20 show twice the noise, free runs 150 times."""
    monkeypatch.setattr(module, "times_noise", lambda problem, fitted, settings: 1.9)
    problem = stub(records=stub(lengths=np.array([120])))
    study, fitted = stub(settings=SETTINGS, budget=SearchBudget(), problem=problem), stub()

    def factors(*effects: Any) -> tuple[int, ...] | None:
        longer = longer_windows(study, stub(effects=effects, current=fitted), judgement(stub), fitted)
        return None if longer is None else longer.window_factors

    assert factors() is None, "windows show it"
    hardly[0] = True
    assert factors() == (1, 3) and factors(stub()) is None, "something was found"


def test_what_longer_windows_find_has_to_explain_most_where_it_had_no_part_in_choosing(stub) -> None:
    before = judgement(stub, run_2=10.0, run_3=4.0)
    for left, explains in (({"run_2": 2.4, "run_3": 1.0}, True), ({"run_2": 2.7, "run_3": 1.0}, False)):
        assert explains_free_runs(before, judgement(stub, **left), SETTINGS, SETTINGS.slow_share) is explains
    # Run 2, which was taken to choose with, does not judge.
    assert not explains_free_runs(before, judgement(stub, run_3=1.1), SETTINGS, SETTINGS.slow_share)
    assert explains_free_runs(before, judgement(stub, run_3=0.9), SETTINGS, SETTINGS.slow_share)


def test_what_the_others_do_not_show_is_asked_of_the_experiment_that_was_taken_to_choose_with(stub) -> None:
    """Seen: a pendulum's stop that one of three validation experiments reaches, once; nothing was said to be missing."""
    before = judgement(stub, run_2=10.0, run_3=0.1)

    def after(run_2: float, plain: float = 1e3) -> Any:
        left = {"run_2": run_2, "run_3": 0.1}
        return stub(
            judges={"run_3"},
            unstable=frozenset(),
            mismatch=lambda effects, among: sum(left[name] if effects else plain for name in among),
        )

    assert explains_free_runs(before, after(2.4), SETTINGS, SETTINGS.slow_share)
    assert not explains_free_runs(before, after(2.6), SETTINGS, SETTINGS.slow_share)
    assert not explains_free_runs(before, after(2.4, plain=9.0), SETTINGS, SETTINGS.slow_share)


def test_experiments_that_no_free_run_follows_count_for_neither(stub) -> None:
    before, after = judgement(stub, run_2=10.0, run_3=500.0), judgement(stub, run_2=5.0, run_3=1.0)
    assert explains_free_runs(before, after, SETTINGS, SETTINGS.slow_share)
    after.unstable = frozenset({"run_3"})
    assert not explains_free_runs(before, after, SETTINGS, SETTINGS.slow_share)


def test_what_the_model_explains_by_itself_with_one_more_experiment_is_not_the_effects_doing(stub) -> None:
    """Seen: a curve at a gearbox, beside a model that explained nearly all of it once that experiment was estimated from."""
    before = judgement(stub, run_2=10.0, run_3=4.0)
    assert explains_free_runs(before, judgement(stub, plain=4.0, run_3=0.9), SETTINGS, SETTINGS.slow_share)
    assert not explains_free_runs(before, judgement(stub, plain=3.0, run_3=0.9), SETTINGS, SETTINGS.slow_share)


@pytest.mark.parametrize(
    ("known", "errors_away", "same", "finding"),
    [((), 4.0, True, True), ((), 2.0, True, False), ((), 4.0, False, False), (("bias",), 2.0, False, True)],
)
def test_new_slow_effects_are_borne_out_and_the_same_everywhere(
    monkeypatch, stub, known, errors_away, same, finding
) -> None:
    bias = stub(prefix="bias", port="rotor")
    monkeypatch.setattr(module, "same_everywhere", lambda *args: same)
    study = stub(settings=SETTINGS, budget=SearchBudget(), surroundings={"rotor": stub()})
    before = (stub(prefixes=set(known), effects=known), {}, judgement(stub, run_2=10.0))
    after_runs = judgement(stub, run_2=1.0)
    after_runs.problem, after_runs.begun = stub(), None
    gains = {"bias": Gain(errors_away * 0.01, 0.01)}
    after = (stub(effects=(bias,), current=stub(values=dict)), gains, after_runs)
    assert stands(study, before, after) is finding
    assert not stands(study, before, (stub(effects=(), current=stub()), {}, after_runs))


def test_less_is_asked_where_free_runs_hardly_follow_without(monkeypatch, stub, hardly) -> None:
    """Seen: a trolley's dry friction beside a lag, 2.0 standard errors by the few windows, 34 % left of 64 to 84 % of the fit."""
    monkeypatch.setattr(module, "same_everywhere", lambda *args: True)
    study = stub(settings=SETTINGS, budget=SearchBudget(), surroundings={"trolley": stub()})
    friction = stub(prefix="friction", port="trolley", mechanism=CoulombFriction())

    def found(errors_away: float, left: float) -> bool:
        runs = judgement(stub, run_2=left)
        runs.problem, runs.begun = stub(), None
        state = stub(effects=(friction,), current=stub(values=dict))
        before = (stub(prefixes=set(), effects=()), {}, judgement(stub, run_2=10.0))
        return stands(study, before, (state, {"friction": Gain(errors_away * 0.01, 0.01)}, runs))

    assert not found(2.0, 3.4)
    hardly[0] = True
    assert found(2.0, 3.4) and not found(0.5, 3.4) and not found(2.0, 5.5)


@pytest.mark.parametrize(
    ("order", "seen", "constant"), [(0.2, False, False), (0.2, True, True), (2.0, False, True), (None, False, True)]
)
def test_a_long_wave_over_a_position_that_no_sensor_shows_is_another_offset_in_each_experiment(
    monkeypatch, stub, order, seen, constant
) -> None:
    """Seen: a complete arm that drifts, told as a ripple of two periods over its travel (0.97): each experiment begins where it fits."""
    monkeypatch.setattr(module, "same_everywhere", lambda *args: True)
    around = stub(ranges={"position": Range(0.0, 60.0, 20.0)})
    study = stub(settings=SETTINGS, budget=SearchBudget(), surroundings={"motor": around})
    values = {} if order is None else {"motor.ripple.order": order}
    model = stub(start_trials=lambda values: [] if seen else [{"motor.position": 0.0}])
    current = stub(values=lambda: values, model=model, problem=stub(values=None))
    judged = judgement(stub, run_2=1.0)
    judged.problem, judged.begun = stub(), None
    ripple = stub(prefix="motor.ripple", port="motor")
    assert constant_effect(study, stub(current=current), judged, ripple) is constant


@pytest.mark.parametrize(
    ("taken_back", "told"), [(False, "which windows of up to 10"), (True, "left hardly more than noise")]
)
def test_what_is_said_of_longer_windows(stub, hardly, taken_back: bool, told: str) -> None:
    def state(steps: int) -> Any:
        return stub(effects=(), current=stub(fits=[stub(windows=stub(steps=steps))]))

    said = sentence(judgement(stub), state(10), stub(effects=(stub(),) if taken_back else ()), state(20))
    assert told in said and "over windows of 20 samples, too." in said
    hardly[0] = True
    assert "Free runs hardly follow" in sentence(judgement(stub), state(10), stub(effects=(stub(),)), state(20))
