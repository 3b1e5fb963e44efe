"""Which of the refitted hypotheses is taken."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.refit.ranked import RankedCandidate
from greybox_torch.diagnosis.screen.candidates import candidates
from greybox_torch.diagnosis.screen.score_test import ScreenScore, _sound
from greybox_torch.diagnosis.screen.shortlist import Candidate, shortlist
from greybox_torch.diagnosis.select import choice
from greybox_torch.diagnosis.select.choice import as_unsure_as_a_name, chosen, part_of_a_curve, simplest
from greybox_torch.diagnosis.select.forward_step import little_is_left, substantial
from greybox_torch.diagnosis.select.remaining import completes, remaining_share
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombFriction, ViscousFriction
from greybox_torch.mechanisms.stribeck import StribeckFriction
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Body
from greybox_torch.simulation.packed_normals import PackedNormals

SETTINGS, BUDGET = DiagnosisSettings(), SearchBudget()
NONE_TOO_SMALL = DiagnosisSettings(least_size=0.0)

WINDOWS = 40

LOUD = 0.3
"""Noise beside which the motion is smooth, so that the recordings tell how much of it there is."""


@pytest.fixture(params=[0.02])
def ranked(motor, begun, motor_data, request):
    """Makes a ranked hypothesis whose windows have given mean squares; the parameter is the noise of the recordings."""
    search = begun(motor_data(noise=request.param), motor)

    def make(mechanism, squares: np.ndarray) -> RankedCandidate:
        whole = {"energies": squares * search.problem.samples / len(squares), "mean_square": float(squares.mean())}
        fits = tuple(replace(fit, **whole) for fit in search.plain.fits)
        fitted = Hypothesis((), search.plain.model, search.plain.simulator, fits, 1e-12)
        gain = search.plain.score - fitted.score
        return RankedCandidate(Candidate(attach(motor, "rotor", mechanism), (), 0.5), fitted, gain, 10.0)

    return make


def test_the_simpler_law_is_meant_where_the_richer_one_is_not_better_by_more_than_chance(ranked) -> None:
    rng = np.random.default_rng(0)
    energies = rng.uniform(0.9, 1.1, WINDOWS)
    scattered = energies * rng.uniform(0.9, 1.1, WINDOWS)
    simple, rich = ranked(CoulombFriction(), energies), ranked(StribeckFriction(), scattered * 0.99)
    assert simplest([rich, simple], simple.fitted, NONE_TOO_SMALL) is simple
    clearly = ranked(StribeckFriction(), 0.5 * scattered)
    assert simplest([clearly, simple], simple.fitted, NONE_TOO_SMALL) is clearly
    assert simplest([simple, rich], simple.fitted, NONE_TOO_SMALL) is simple
    assert simplest([], simple.fitted, NONE_TOO_SMALL) is None


def test_a_curve_is_taken_only_where_it_goes_much_farther(ranked) -> None:
    named = ranked(CoulombFriction(), np.full(WINDOWS, 1e-3))
    little, much = (ranked(Unknown("speed"), np.full(WINDOWS, e)) for e in (0.95e-3, 1e-9))
    assert chosen([little, named], named.fitted, NONE_TOO_SMALL) is named
    assert chosen([much, named], named.fitted, NONE_TOO_SMALL) is much
    assert chosen([much], named.fitted, NONE_TOO_SMALL) is much


def test_a_name_that_is_part_of_what_a_curve_removes_is_none(ranked) -> None:
    """Seen: a complete arm at one and a half times its noise, told to lack a soft stop where a curve gained 3.6 times as much."""

    def gaining(mechanism: Any, gain: float) -> RankedCandidate:
        return replace(ranked(mechanism, np.full(WINDOWS, 1.0)), gain=gain)

    named = gaining(CoulombFriction(), 0.016)
    for most, part in ((0.045, False), (0.058, True)):
        curve = gaining(Unknown("speed"), most)
        assert part_of_a_curve(named, [curve, named], SETTINGS) is part
        assert not part_of_a_curve(curve, [curve, named], SETTINGS)
    assert not part_of_a_curve(named, [named], SETTINGS)


@pytest.mark.parametrize(
    ("named", "at_noise", "unsure"), [(0.092, True, True), (0.092, False, False), (0.01, True, False)]
)
def test_a_curve_hardly_beyond_a_name_that_is_not_sure_is_not_sure_at_the_noise(
    ranked, monkeypatch, named: float, at_noise: bool, unsure: bool
) -> None:
    """Seen: a complete arm whose slow drift a constant force drew nearly as well; the curve was told (0.95)."""
    monkeypatch.setattr(choice, "noise_over_windows", lambda fitted, settings: at_noise)

    def gaining(mechanism: Any, gain: float) -> RankedCandidate:
        return replace(ranked(mechanism, np.full(WINDOWS, 1.0)), gain=gain)

    bias, curve = gaining(ConstantBias(), named), gaining(Unknown("speed"), 0.119)
    assert as_unsure_as_a_name(curve, curve.fitted, [curve, bias], SETTINGS) is unsure
    assert not as_unsure_as_a_name(bias, curve.fitted, [bias, curve], SETTINGS), "a name leads"
    far = gaining(Unknown("speed"), named + 2.0)
    assert not as_unsure_as_a_name(far, curve.fitted, [far, bias], SETTINGS), "it goes much farther"


def test_a_curve_is_also_refitted_from_a_part_of_it(dead_zone_search) -> None:
    search = dead_zone_search
    fit: WindowFit = search.plain.fits[0]
    curve = attach(search.problem.model, "rotor", Unknown("speed"))
    probe = curve.mechanism.probes(search.surroundings["rotor"])[0]
    score = ScreenScore(curve, probe, 31, 0.4, np.arange(1.0, 15.0))
    (candidate,) = shortlist(search.study, [[score]], [fit])
    whole, part = candidate.starts[:2]
    heights = [f"{curve.prefix}.w_{k}" for k in range(14)]
    assert [whole[n] for n in heights] == list(score.size)
    assert [part[n] for n in heights] == pytest.approx(BUDGET.part_of_curve * score.size)


def test_what_repeats_once_per_turn_is_not_offered_on_a_length(motor, dead_zone_search) -> None:
    around = dict(dead_zone_search.surroundings)
    names = {"gravity", "torque_ripple", "position_dependent_friction"}

    def offered() -> set[str]:
        return {a.mechanism.name for a in candidates(motor, {}, around, flexible=False)} & names

    assert any(isinstance(port, Body) for port in motor.ports)
    assert offered() == names
    around["rotor"] = replace(around["rotor"], units={**around["rotor"].units, "position": "m"})
    assert offered() == set()


def test_windows_that_fail_are_passed_over_and_probes_that_fail_are_dropped() -> None:
    normal = np.ones((3, 4, 4))
    normal[1, 0, 0] = np.nan  # the model itself
    normal[2, 2, 2] = np.inf  # a probe
    packed = PackedNormals.whole(normal[..., None], 3)
    sound = _sound(packed, np.array([0, 1, 3])).rows(np.arange(4))
    assert np.isfinite(sound).all()
    assert (sound[1] == 0).all()
    assert (sound[[0, 2], 2] == 0).all() and (sound[[0, 2], :, 2] == 0).all()
    assert (sound[0, :2, :2] == 1).all()
    whole = PackedNormals.whole(np.ones((2, 3, 3, 1)), 2)
    assert _sound(whole, np.array([0])) is whole


def test_what_a_law_lacks_is_not_a_curve_of_its_own(dead_zone_search, ranked) -> None:
    """Of a mismatch of 1, a curve must explain two per cent, however significant that is."""
    search, left = dead_zone_search, np.full(WINDOWS, 0.1)
    fits = tuple(replace(f, mean_square=1.0) for f in search.plain.fits)
    now = tuple(replace(f, mean_square=0.1) for f in search.plain.fits)
    state = replace(search.state, plain=replace(search.plain, fits=fits), current=replace(search.plain, fits=now))
    little, enough = (replace(ranked(Unknown("speed"), left - part), gain=0.2) for part in (0.018, 0.022))
    assert not substantial(search.study, state, little)
    assert substantial(search.study, state, enough)
    assert not substantial(
        search.study, state, replace(enough, gain=0.09)
    )  # within the margin it would give way to names, or to nothing


@pytest.mark.parametrize("ranked", [LOUD], indirect=True)
def test_the_simpler_law_is_meant_where_the_richer_one_removes_little_more_of_the_whole(ranked) -> None:
    """Much more than chance, and yet a crumb beside the mismatch: unless with it noise alone is left."""
    spread = np.random.default_rng(0).uniform(0.9, 1.1, WINDOWS)
    plain, simple = ranked(ViscousFriction(), 100 * spread), ranked(CoulombFriction(), 1.0 * spread)
    crumb, complete = ranked(StribeckFriction(), 0.8 * spread), ranked(StribeckFriction(), LOUD**2 * spread)
    assert simplest([crumb, simple], plain.fitted, DiagnosisSettings(least_size=0.02)) is simple
    assert simplest([crumb, simple], plain.fitted, DiagnosisSettings(least_size=0.001)) is crumb
    assert simplest([complete, simple], plain.fitted, DiagnosisSettings(least_size=0.02)) is complete


@pytest.mark.parametrize(("whole", "left", "rich"), [(30, 0.4, True), (30, 0.8, False), (300, 0.4, False)])
@pytest.mark.parametrize("ranked", [LOUD], indirect=True)
def test_the_richer_law_is_meant_where_it_removes_most_of_what_the_simpler_one_leaves(
    ranked, whole: float, left: float, rich: bool
) -> None:
    """And more than any law lacks to be the machine's. Seen: the LuGre friction of a table, told as Coulomb friction (0.85)."""
    spread = np.random.default_rng(0).uniform(0.9, 1.1, WINDOWS)
    plain, simple = ranked(ViscousFriction(), whole * spread), ranked(CoulombFriction(), 1.0 * spread)
    richer = ranked(StribeckFriction(), left * spread)
    assert simplest([richer, simple], plain.fitted, SETTINGS) is (richer if rich else simple)


@pytest.mark.parametrize(("differ", "first"), [(1e-7, "size"), (1e-3, "rich")])
def test_of_laws_that_differ_by_next_to_nothing_the_one_with_fewer_parameters_is_meant(ranked, differ, first) -> None:
    """Seen: a motor's gain told as gravity (0.78), which has one parameter more and an offset of 3e-4 of its amplitude to say with it."""
    spread = np.random.default_rng(0).uniform(0.9, 1.1, WINDOWS)
    plain, gain = ranked(ViscousFriction(), 1e3 * spread), ranked(ConstantBias(), (1.0 + 1e3 * differ) * spread)
    gravity = ranked(StribeckFriction(), 1.0 * spread)
    sized = [replace(r, fitted=replace(r.fitted, fits=with_free(r, n))) for r, n in ((gravity, 3), (gain, 1))]
    assert [r.size for r in sized] == [3, 1]
    told = simplest(sized, plain.fitted, DiagnosisSettings())
    assert told is sized[1 if first == "size" else 0]


def test_laws_that_the_likelihood_tells_apart_are_not_the_same(ranked) -> None:
    """Seen: one more mode of an arm, 54 nats likelier than a motor's gain, told as the gain."""
    spread = np.random.default_rng(0).uniform(0.9, 1.1, WINDOWS)
    plain, gain = ranked(ViscousFriction(), 1e3 * spread), ranked(ConstantBias(), 1.0001 * spread)
    mode = ranked(StribeckFriction(), 1.0 * spread)
    sized = [replace(r, fitted=replace(r.fitted, fits=with_free(r, n))) for r, n in ((mode, 3), (gain, 1))]
    weighed = [replace(r, cost=cost) for r, cost in zip(sized, (-12452.9, -12398.9), strict=True)]
    assert simplest(sized, plain.fitted, DiagnosisSettings()) is sized[1]
    assert simplest(weighed, plain.fitted, DiagnosisSettings()) is weighed[0]


def with_free(ranked: RankedCandidate, count: int) -> tuple[Any, ...]:
    """The fits of a ranked hypothesis, as if its effect had so many free parameters."""
    own = tuple(f"{ranked.candidate.attachment.prefix}.{k}" for k in range(count))
    return tuple(replace(f, problem=Sized(f.problem, own)) for f in ranked.fitted.fits)


class Sized:
    """A problem with other names of free parameters."""

    def __init__(self, problem: Any, free_names: tuple[str, ...]) -> None:
        self.problem, self.free_names = problem, free_names

    def __getattr__(self, name: str) -> Any:
        return getattr(self.problem, name)


@pytest.mark.parametrize("ranked", [LOUD], indirect=True)
def test_what_is_left_is_counted_beyond_the_noise(ranked) -> None:
    plain, half, noise = (ranked(ViscousFriction(), np.full(WINDOWS, e)).fitted for e in (10.0, 5.0, 0.9 * LOUD**2))
    assert remaining_share(plain, half, SETTINGS) == pytest.approx(0.5, rel=1e-2)
    assert remaining_share(plain, noise, SETTINGS) == 0.0
    over_long_windows = replace(plain, fits=(noise.fits[0], *plain.fits[1:]))
    assert remaining_share(over_long_windows, half, SETTINGS) == pytest.approx(0.5, rel=1e-2), "short ones say nothing"
    assert completes(noise, SETTINGS) and not completes(half, SETTINGS)
    assert (
        remaining_share(noise, noise, SETTINGS) == 1.0
    )  # where the plain model leaves noise alone there is no mismatch to have a share of


@pytest.mark.parametrize("ranked", [LOUD], indirect=True)
def test_little_is_not_little_where_free_runs_show_that_more_is_missing(stub, ranked) -> None:
    """Seen: an arm's drag beside a delay: 0.1 % of the mismatch over windows, a quarter of it in free runs."""
    plain, fitted = (ranked(ViscousFriction(), np.full(WINDOWS, e)).fitted for e in (1000.0, 1.2 * LOUD**2))
    state = stub(effects=("friction",), plain=plain, current=fitted)
    assert little_is_left(stub(settings=SETTINGS, more_is_missing=False), state)
    assert not little_is_left(stub(settings=SETTINGS, more_is_missing=True), state)
