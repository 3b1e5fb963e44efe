"""Which trials are refitted in full."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.hypothesis.fit import window_lengths
from greybox_torch.diagnosis.refit import behind_curve
from greybox_torch.diagnosis.refit import rank as rank_module
from greybox_torch.diagnosis.refit.behind_curve import laws_behind_curve
from greybox_torch.diagnosis.refit.rank import rank
from greybox_torch.diagnosis.refit.ranked import RankedCandidate
from greybox_torch.diagnosis.screen.score_test import ScreenScore
from greybox_torch.diagnosis.screen.shortlist import Candidate, shortlist
from greybox_torch.diagnosis.select.offered import screen_scores
from greybox_torch.mechanisms.actuator import InputGain
from greybox_torch.mechanisms.actuator_deadzone import ActuatorDeadzone
from greybox_torch.mechanisms.attachment import Attachment, attach
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.unknown import Unknown

NOISE_UNKNOWN = {"noise_floors_agree": 1.0 + 1e-9}


def refitted_in_full(found: Any, **settings: float) -> list[str]:
    """What :func:`rank` refits in full of the named candidates that the screen passes on."""
    told: list[str] = []
    study = replace(found.study, report=told.append, settings=replace(found.study.settings, **settings))
    screened = screen_scores(study, found.state, curves=False, fine=False)
    told.clear()
    rank(study, found.state.current, shortlist(study, screened, found.state.current.fits))
    return [text for text in told if text.endswith("in full")]


def test_far_behind_the_best_trial_none_is_refitted_unless_the_best_do_not_pay(dead_zone_search) -> None:
    everyone = refitted_in_full(dead_zone_search, finalist_share=0.0, **NOISE_UNKNOWN)
    near = refitted_in_full(dead_zone_search, finalist_share=0.9, **NOISE_UNKNOWN)
    assert near[0] == "refitting actuator.actuator_deadzone in full"
    assert 0 < len(near) < len(everyone)
    unsure = refitted_in_full(dead_zone_search, finalist_share=0.9, least_significance=1e9, **NOISE_UNKNOWN)
    assert sorted(unsure) == sorted(everyone)


@pytest.mark.parametrize(("ends", "tries"), [(1.5, 2), (0.9, 1)])
def test_a_trial_that_ends_worse_than_without_the_effect_begins_again_from_there(
    dead_zone_search, monkeypatch, ends, tries
) -> None:
    """As where a screen suggests far too much of a friction that sticks."""
    found, begins, current = dead_zone_search, [], dead_zone_search.state.current
    (one, *_) = shortlist(found.study, screen_scores(found.study, found.state, curves=False, fine=False), current.fits)

    def fit(study: Any, effects: Any, starts: Any, *, at: Any = None, **how: Any) -> Any:
        begins.extend(starts if at else ())
        times, fits = ends if len(begins) == 1 else 0.5, current.fits[1:2] if at else current.fits
        return replace(current, fits=tuple(replace(f, mean_square=times * f.mean_square) for f in fits))

    monkeypatch.setattr("greybox_torch.diagnosis.refit.rank.fit", fit)
    astray = Candidate(one.attachment, ({"size": 9.0},), 0.5, steps=current.fits[1].windows.steps, absent={"size": 0.0})
    rank(found.study, current, [astray])
    assert begins == [{"size": 9.0}, {**current.fits[1].problem.values_by_name, "size": 0.0}][:tries]


def test_the_law_without_its_size_is_at_hand_where_it_has_one(dead_zone_search) -> None:
    search, around = dead_zone_search, dead_zone_search.surroundings
    dry = attach(search.problem.model, "rotor", CoulombFriction())
    zone = attach(search.problem.model, "actuator", ActuatorDeadzone())
    scores = [ScreenScore(a, a.mechanism.probes(around[a.port])[-1], 31, 0.4, np.array([2.0])) for a in (dry, zone)]
    of_dry, of_zone = (shortlist(search.study, [[score]], search.plain.fits[:1])[0] for score in scores)
    size, width = (f"{dry.prefix}.{name}" for name in ("F_c", "v_0"))
    assert of_dry.starts[0][size] > 0 and of_dry.absent == {size: 0.0, width: of_dry.starts[0][width]}
    assert not of_zone.absent, "probed with a width, a dead zone has no size"


def test_what_does_not_show_over_middle_windows_is_tried_where_the_screen_saw_it(dead_zone_search, monkeypatch) -> None:
    """An overflow shows over windows that are long enough to run over; over others its trial says nothing."""
    found, tried = dead_zone_search, []
    study, current = found.study, found.state.current
    shortest, middle = (f.windows.steps for f in current.fits[:2])
    (one, *_) = shortlist(study, screen_scores(study, found.state, curves=False, fine=False), current.fits)

    def fit(*given: Any, at: Any = None, **how: Any) -> Any:
        tried.extend(at or ["in full"])
        better = 0.5 if at is None or at == window_lengths(study.problem)[:1] else 1.0
        own = [
            f for f, length in zip(current.fits, window_lengths(study.problem), strict=True) if at in (None, [length])
        ]
        return replace(current, fits=tuple(replace(f, mean_square=better * f.mean_square) for f in own))

    monkeypatch.setattr("greybox_torch.diagnosis.refit.rank.fit", fit)
    monkeypatch.setattr("greybox_torch.diagnosis.refit.rank._pays", lambda study, ranked: True)
    rank(study, current, [replace(one, steps=shortest)])
    assert tried == [*window_lengths(study.problem)[1::-1], "in full"]
    tried.clear()
    rank(study, current, [replace(one, steps=middle)])
    assert tried == [window_lengths(study.problem)[1], "in full"]
    tried.clear()
    rank(study, current, [replace(one, steps=shortest, explained=0.05)])  # what promises little is not followed there
    assert tried == [window_lengths(study.problem)[1], "in full"]


def test_what_was_found_before_is_tried_over_all_windows(dead_zone_search, monkeypatch) -> None:
    """Seen: an arm's stop, found with one experiment; with a second one the screen promised 3 % of it over middle windows, it was not
    refitted where it shows, and the stop was told at the gearbox (0.97).
    """
    found, tried = dead_zone_search, []
    study, current = found.study, found.state.current
    shortest, middle, longest = window_lengths(study.problem)
    (one, *_) = shortlist(study, screen_scores(study, found.state, curves=False, fine=False), current.fits)

    def fit(*given: Any, at: Any = None, **how: Any) -> Any:
        tried.extend(at or ["in full"])
        own = [f for f, n in zip(current.fits, window_lengths(study.problem), strict=True) if at in (None, [n])]
        better = 0.5 if at in (None, [longest]) else 1.0
        return replace(current, fits=tuple(replace(f, mean_square=better * f.mean_square) for f in own))

    monkeypatch.setattr("greybox_torch.diagnosis.refit.rank.fit", fit)
    monkeypatch.setattr("greybox_torch.diagnosis.refit.rank._pays", lambda study, ranked: True)
    little = replace(one, steps=current.fits[1].windows.steps, explained=0.03)
    rank(study, current, [replace(little, found_before=({"size": 1.0},))])
    assert tried == [middle, shortest, longest, "in full"]
    tried.clear()
    rank(study, current, [little])
    assert tried == [middle, "in full"]


def test_heights_of_a_curve_rest_but_beside_a_gain(dead_zone_search, motor, monkeypatch) -> None:
    """Seen: the gain of a wheel's torque, no rival of the gain of its sensor (0.97) as long as the curve at its pivot rested."""
    search, rested = dead_zone_search, {}
    curve = attach(motor, "rotor", Unknown("speed"))
    current = search.refitted((curve,), search.plain)

    def fit(study: Any, effects: Any, starts: Any, *, frozen: frozenset[str], **how: Any) -> None:
        rested[effects[-1].mechanism.name] = len(frozen)

    monkeypatch.setattr("greybox_torch.diagnosis.refit.rank.fit", fit)
    laws = (attach(motor, "actuator", InputGain()), attach(motor, "rotor", CoulombFriction()))
    assert rank(search.study, current, [Candidate(law, ({},), 0.5) for law in laws]) == []
    heights = [p for p in current.model.declared_parameters if p.shrunk]
    assert heights and rested == {"input_gain": 0, "coulomb_friction": len(heights)}


def test_trials_are_compared_over_the_same_windows(dead_zone_search, monkeypatch) -> None:
    """Seen: a stop that removed all but the noise over middle windows, behind three laws that removed a third over the longest."""
    found, tried = dead_zone_search, []
    study, current = found.study, found.state.current
    _, middle, longest = window_lengths(study.problem)
    steps = current.fits[2].windows.steps
    offered = shortlist(study, screen_scores(study, found.state, curves=False, fine=False), current.fits)
    stop, other = (replace(c, steps=steps, explained=e) for c, e in zip(offered[:2], (0.86, 0.43), strict=True))
    names = {"stop": stop.attachment.named, "other": other.attachment.named}
    left = {("stop", middle): 0.8, ("stop", longest): 0.1, ("other", middle): 1.0, ("other", longest): 0.6}

    def fit(study: Any, effects: Any, starts: Any, *, at: Any = None, **how: Any) -> Any:
        one = "stop" if names["stop"] in [e.named for e in effects] else "other"
        tried.append((one, *(at or ["in full"])))
        which = [k for k, length in enumerate(window_lengths(study.problem)) if at in (None, [length])]
        share = left.get((one, *(at or ())), 0.5)
        return replace(
            current,
            fits=tuple(replace(current.fits[k], mean_square=share * current.fits[k].mean_square) for k in which),
        )

    monkeypatch.setattr("greybox_torch.diagnosis.refit.rank.fit", fit)
    monkeypatch.setattr("greybox_torch.diagnosis.refit.rank._pays", lambda study, ranked: True)
    alone = replace(study, budget=replace(study.budget, finalists=1, most_tied=1))
    (first,) = rank(alone, current, [other, stop])
    assert first.candidate == stop, "by what it removes over the longest windows"
    assert ("stop", longest) in tried
    tried.clear()
    rank(alone, current, [stop])
    assert [where for _, where in tried] == [middle, "in full"], "nothing else is compared there"


@pytest.mark.parametrize(("before", "over_middle"), [((), 0.6), (({"size": 1.0},), 0.99)], ids=["new", "found before"])
def test_what_leads_over_middle_windows_is_refitted_where_others_show_over_longer_ones(
    dead_zone_search, monkeypatch, before, over_middle
) -> None:
    """Seen: a pendulum's friction, no finalist beside what promised much over longer windows; the verdict said that nothing is missing.
    Likewise a gearbox's friction, found before and so tried over all windows, of which it led over the middle ones.
    """
    found, in_full = dead_zone_search, []
    study, current = found.study, found.state.current
    shortest, middle, longest = window_lengths(study.problem)
    offered = shortlist(study, screen_scores(study, found.state, curves=False, fine=False), current.fits)
    stop = replace(offered[0], steps=current.fits[2].windows.steps, explained=0.86)
    friction = replace(offered[1], steps=current.fits[1].windows.steps, explained=0.43, found_before=before)
    left = {("stop", middle): 1.0, ("stop", longest): 0.1}
    left |= {("friction", shortest): 1.0, ("friction", middle): over_middle, ("friction", longest): 0.9}

    def fit(study: Any, effects: Any, starts: Any, *, at: Any = None, **how: Any) -> Any:
        one = "stop" if stop.attachment.named in [e.named for e in effects] else "friction"
        in_full.extend([one] if at is None else [])
        which = [k for k, length in enumerate(window_lengths(study.problem)) if at in (None, [length])]
        share = left[one, *at] if at else 0.5
        return replace(
            current,
            effects=tuple(effects),
            fits=tuple(replace(current.fits[k], mean_square=share * current.fits[k].mean_square) for k in which),
        )

    monkeypatch.setattr("greybox_torch.diagnosis.refit.rank.fit", fit)
    monkeypatch.setattr("greybox_torch.diagnosis.refit.rank._pays", lambda study, ranked: True)
    rank(replace(study, budget=replace(study.budget, finalists=1, most_tied=1)), current, [stop, friction])
    assert sorted(in_full) == ["friction", "stop"]


def test_beside_one_at_the_noise_none_is_refitted_that_is_behind_it(dead_zone_search) -> None:
    """However little of its gain a rival would have to bring."""
    assert refitted_in_full(dead_zone_search, finalist_share=0.0) == ["refitting actuator.actuator_deadzone in full"]


def test_a_law_that_is_there_already_is_not_refitted_from_the_curve(dead_zone_search, monkeypatch) -> None:
    law, curve = Attachment("rotor", CoulombFriction()), Attachment("rotor", Unknown("speed"))
    fitted = dead_zone_search.plain
    ranked = [RankedCandidate(Candidate(a, ({},), 1.0), fitted, 1.0, 9.0) for a in (curve, law)]
    monkeypatch.setattr(behind_curve, "laws_on_curve", lambda *_: [Candidate(law, ({},), 1.0)])
    monkeypatch.setattr(behind_curve, "fit", lambda *_, **__: fitted)
    behind = partial(laws_behind_curve, dead_zone_search.study, fitted, frozen=frozenset())
    assert [r.candidate.attachment for r in behind(ranked[:1])] == [law]
    assert behind(ranked) == []


def test_a_refit_in_full_also_begins_where_the_law_says_after_its_trial(dead_zone_search, monkeypatch) -> None:
    elsewhere = {"v_0": 0.5}
    monkeypatch.setattr(CoulombFriction, "begun_elsewhere", lambda self, around, values: [elsewhere])
    early: list[Any] = []

    def recorded(*args: Any, **how: Any) -> Any:
        early.extend(how.get("early", ()))
        return fit(*args, **how)

    fit = rank_module.fit
    monkeypatch.setattr(rank_module, "fit", recorded)
    search = dead_zone_search
    friction = attach(search.problem.model, "rotor", CoulombFriction())
    begun = {**search.plain.values(), "rotor.coulomb_friction.F_c": 0.01, "rotor.coulomb_friction.v_0": 0.1}
    rank(search.study, search.plain, [Candidate(friction, (begun,), 0.5)])
    assert begun in early
    assert [e["rotor.coulomb_friction.v_0"] for e in early if e != begun] == [0.5]
