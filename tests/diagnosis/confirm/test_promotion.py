"""Experiments that join those to choose with, where these do not show what others do."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm import promotion
from greybox_torch.diagnosis.confirm.held_out import Gain, HeldOut
from greybox_torch.diagnosis.confirm.promotion import (
    promote_for_a_curve,
    promote_refusing,
    promote_unstable,
    promote_validation,
    replaces,
    serves,
)
from greybox_torch.diagnosis.pipeline import diagnose
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.friction import QuadraticDrag

from ..conftest import STEP
from .conftest import FAST, SLOW


def test_what_only_other_experiments_show_is_found_with_one_of_them(drag_at_speed, motor) -> None:
    data = drag_at_speed()
    verdict = diagnose(data, motor).verdict
    (effect,) = verdict.effects
    assert (effect.port, effect.mechanism) == ("rotor", "quadratic_drag")
    assert effect.parameters["c"]["value"] == pytest.approx(0.01, rel=0.05)
    roles = {s.experiment: s.role for s in verdict.scores["augmented"]}
    assert sorted(roles.values()) == ["estimation", "estimation", "validation"]
    taken = next(r.name for r in data.recordings if r.role != roles[r.name])
    assert any(line.startswith(f"{taken} was taken to choose with") for line in verdict.evidence)
    assert verdict.no_longer_validation == (
        f"{taken} no longer counts as validation: it was taken to choose with as well (the evidence says why).",
    )
    assert [r.role for r in data.recordings] == ["estimation", "validation", "validation"]
    kept = diagnose(data, motor, settings=DiagnosisSettings(most_promoted=0)).verdict
    assert kept.no_longer_validation == () and not any("to choose with" in line for line in kept.evidence)


@pytest.mark.parametrize(("levels", "drag"), [((SLOW, FAST), 0.01), ((SLOW, FAST, FAST), 0.0)])
def test_nothing_is_taken_where_none_would_be_left_or_none_shows_more(
    drag_at_speed, motor, begun, levels, drag
) -> None:
    data = drag_at_speed(levels, drag)
    search = begun(data, motor)
    assert promote_validation(search.study, data, search.state, HeldOut(data, search.study)) is None


def test_the_experiment_that_shows_most_is_taken(drag_at_speed, motor, begun) -> None:
    data = drag_at_speed((SLOW, 1.0, FAST))
    search = begun(data, motor)
    more = promote_validation(search.study, data, search.state, HeldOut(data, search.study))
    assert more is not None and more.taken == data.recordings[2].name
    assert float(more.why.split("leaves ")[1].split(" times")[0]) > 1.5
    assert [r.role for r in more.dataset.recordings] == ["estimation", "validation", "estimation"]


@pytest.mark.parametrize(
    ("farther", "left", "roles", "taken"),
    [
        (0.6, (2.5, 9.0, 4.0), 3, True),
        (0.0, (2.5, 9.0, 4.0), 3, False),
        (0.6, (1.1, 1.4, 1.0), 3, False),
        (0.6, (9.0,), 1, False),
    ],
    ids=["goes farther", "goes no farther", "noise alone is left", "none would be left"],
)
def test_where_a_curve_was_not_drawn_it_is_drawn_before_names_stand_for_it(
    data_set, stub, farther, left, roles, taken
) -> None:
    """Seen: waves in a stage's friction over its speed, told as Coulomb friction (0.85), which left 6 % at 58 times the noise."""
    runs = [{"force": np.zeros(3)} for _ in range(1 + roles)]
    data = data_set({"force": "N"}, runs, roles=["estimation", *["validation"] * roles], sample_time=STEP)
    curve, friction = (stub(mechanism=stub(free=free)) for free in (True, False))
    searched, names = stub(effects=(curve,), score=-farther), stub(effects=(friction,), score=0.0)
    noise = {searched: np.array([1.0, 30.0, 4.0][:roles]), names: np.array(left)}
    others: Any = stub(times_noise=lambda hypothesis: noise[hypothesis], study=stub(settings=DiagnosisSettings()))
    state: Any = stub(effects=(friction,), has_curve=False, current=names)
    more = promote_for_a_curve(data, state, others, searched)  # type: ignore[arg-type]
    assert (
        (more is not None and more.taken == data.validation()[1].name and not more.same_effects)
        if taken
        else more is None
    )
    assert promote_for_a_curve(data, stub(effects=(), has_curve=False), others, searched) is None  # type: ignore[arg-type]


def test_what_explains_the_others_is_left_as_it_is(drag_at_speed, motor, begun) -> None:
    data = drag_at_speed((FAST, FAST, FAST))
    search = begun(data, motor)
    others = HeldOut(data, search.study)
    assert promote_validation(search.study, data, search.state, others) is not None
    complete = begun(data, motor)
    complete = complete.at(complete.refitted((attach(motor, "rotor", QuadraticDrag()),), complete.plain))
    assert promote_validation(search.study, data, complete.state, others) is None
    search, complete = search.state, complete.state
    assert serves(others, search, complete) and not serves(others, complete, search)
    assert serves(others, complete, complete) is False and serves(others, search, search)


def test_where_one_more_experiment_shows_that_nothing_is_missing_that_is_the_answer(
    drag_at_speed, motor, begun, monkeypatch
) -> None:
    """Seen: an arm that never rests while it is estimated, and that rests while it is validated: "missing, without a name".

    Also seen: friction that warms up, which made up for what that experiment did not tell of the model's own friction.
    """
    data, wrong = drag_at_speed((FAST, FAST, FAST), drag=0.0), drag_at_speed((FAST, FAST, FAST))
    right, lacking = begun(data, motor), begun(wrong, motor)
    complete, others = right.state, HeldOut(data, right.study)
    spurious = lacking.at(lacking.refitted((attach(motor, "rotor", QuadraticDrag()),), lacking.plain)).state
    assert replaces(others, lacking.state, complete)
    assert not replaces(HeldOut(wrong, lacking.study), lacking.state, lacking.state), "more than noise is left"
    assert replaces(others, spurious, complete), "drag that is not there predicts worse"
    monkeypatch.setattr(promotion, "gain", lambda before, after: Gain(0.1, 0.01))
    assert not replaces(others, spurious, complete), "what predicts better beyond chance is not forgotten"


def test_what_adds_to_what_was_found_need_not_show_in_the_experiments_that_are_left(monkeypatch, stub) -> None:
    """Seen: dry friction, and a stop that one validation experiment alone reached; the two left to judge said neither yes nor no."""
    alike, worse = Gain(-0.01, 0.01), Gain(-0.3, 0.01)
    friction, stop, lag, delay = (
        stub(prefix=p, mechanism=stub(nature=n))
        for p, n in (("friction", "dry friction"), ("stop", ""), ("lag", "a time shift"), ("delay", "a time shift"))
    )

    def state(*effects: Any) -> dict[str, Any]:
        prefixes = {e.prefix for e in effects}
        return {"current": "+".join(sorted(prefixes)), "effects": effects, "prefixes": prefixes, "plain": "plain"}

    found, more, other = state(friction), state(friction, stop), state(stop)
    monkeypatch.setattr(promotion, "size", lambda *args: 0.5)
    others = stub(fits=lambda hypothesis: hypothesis, study=stub(settings=DiagnosisSettings()))
    for before, after, by_more, takes in (
        (found, more, alike, True),
        (found, other, alike, False),
        (found, more, worse, False),
        (state(delay), state(lag, stop), alike, True),  # which of the two it is, the stop has decided
        (state(delay), state(friction, stop), alike, False),
    ):
        better_before, names = Gain(-by_more.share, by_more.error), (before["current"], after["current"])
        gains = {names: by_more, names[::-1]: better_before}
        monkeypatch.setattr(promotion, "gain", lambda old, new, gains=gains: gains[old, new])
        assert serves(others, stub(**before), stub(**after)) is takes


def test_the_noise_of_other_experiments_is_the_unit_of_their_errors(drag_at_speed, motor, begun) -> None:
    data = drag_at_speed((FAST, FAST, SLOW), drag=0.0)
    search = begun(data, motor)
    errors = HeldOut(data, search.study).times_noise(search.current)
    assert errors == pytest.approx([1.0, 1.0], abs=0.1)


def test_an_experiment_that_no_free_run_follows_is_taken_as_long_as_another_judges(drag_at_speed) -> None:
    data = drag_at_speed()
    last, before = data.recordings[2].name, data.recordings[1].name
    more = promote_unstable(data, {last})
    assert more is not None and [r.role for r in more.dataset.recordings] == ["estimation", "validation", "estimation"]
    assert more.sentence() == (
        f"{last} was taken to choose with as well, as no free run of the model found before follows it: it no longer counts as validation."
    )
    assert promote_unstable(more.dataset, {before}) is None
    assert promote_unstable(data, set()) is None


@pytest.mark.parametrize(
    ("refused_in", "effects", "removed", "taken"),
    [
        ("third", (), Gain(0.98, 0.01), True),
        ("", (), Gain(0.98, 0.01), False),
        ("third", ("something",), Gain(0.98, 0.01), False),
        ("third", (), Gain(0.1, 0.01), False),
        ("third", (), Gain(0.98, 0.9), False),
    ],
)
def test_the_experiment_whose_free_runs_refuse_what_windows_bear_out_is_taken(
    drag_at_speed, monkeypatch, stub, refused_in, effects, removed, taken
) -> None:
    """Seen: a bump in a stage's friction at 0.22 m/s, taken back for a recording of slow motion, and nothing told after 257 s."""
    data = drag_at_speed()
    names = {"third": data.recordings[2].name, "": ""}
    others = stub(fits=lambda hypothesis: hypothesis, study=stub(settings=DiagnosisSettings()))
    monkeypatch.setattr(promotion, "gain", lambda before, after: removed)
    state = stub(effects=effects, plain="plain")
    more = promote_refusing(data, state, others, stub(), names[refused_in])
    assert (more is not None) is taken
    if more is not None:
        assert more.taken == names[refused_in] and "which windows bear out" in more.sentence()
        assert promote_refusing(more.dataset, state, others, stub(), data.recordings[1].name) is None, (
            "none would judge"
        )


@pytest.mark.parametrize(
    ("share", "settles", "takes"), [(-0.01, True, True), (-0.3, True, False), (-0.01, False, False)]
)
def test_the_same_effects_estimated_from_what_cannot_score_as_well_are_preferred(
    monkeypatch, stub, share, settles, takes
) -> None:
    before, after = (stub(current=c, effects=("curve",), prefixes={"curve"}) for c in ("before", "after"))
    others = stub(fits=lambda hypothesis: hypothesis, study=stub(settings=DiagnosisSettings()))
    sign = {("before", "after"): 1.0, ("after", "before"): -1.0}
    monkeypatch.setattr(promotion, "gain", lambda old, new: Gain(share * sign[old, new], 0.01))
    assert replaces(others, before, after, settles) is takes


@pytest.mark.parametrize(("lost", "found", "takes"), [(0.003, (), True), (0.3, (), False), (0.003, ("lag",), True)])
def test_what_was_taken_shows_an_effect_that_lacks_a_little_to_be_the_machines(
    monkeypatch, stub, lost, found, takes
) -> None:
    """Seen: a stop that one experiment reached; beside it the two left to judge rose from 1.0 to 1.6 times the noise, 36 standard errors.

    The model as it stands, estimated from what was taken, left 700 times the noise there.
    """
    effects = tuple(stub(prefix=p, mechanism=stub(nature="")) for p in found)
    before = stub(current="before", effects=effects, prefixes=set(found))
    after = stub(current="after", plain="plain", effects=(*effects, "stop"), prefixes={*found, "stop"})
    others = stub(fits=lambda hypothesis: hypothesis, study=stub(settings=DiagnosisSettings()))
    monkeypatch.setattr(promotion, "gain", lambda old, new: Gain(0.9 if new == "before" else -9.0, 0.03))
    shares = {("plain", "after", "before"): lost}
    monkeypatch.setattr(promotion, "size", lambda plain, without, full, settings: shares[plain, without, full])
    assert replaces(others, before, after) is takes
