"""How large effects are, and from which size they are findings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm import standing
from greybox_torch.diagnosis.confirm.held_out import Gain, HeldOut
from greybox_torch.diagnosis.confirm.sizes import sizes
from greybox_torch.diagnosis.confirm.standing import least_size, refinements, sharing_with_the_rest
from greybox_torch.diagnosis.hypothesis.size import size
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.actuator import InputDelay, InputLag
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombFriction, ViscousFriction
from greybox_torch.mechanisms.mechanism import Mechanism
from greybox_torch.mechanisms.presliding import PreslidingHysteresis
from greybox_torch.mechanisms.stiffness import NonlinearStiffness
from greybox_torch.mechanisms.transmission import Backlash


@pytest.fixture
def fits(motor, begun, motor_data):
    """Fits of the motor at every window length, with a given mean squared error."""
    found = begun(motor_data(), motor)

    def make(error: float):
        return tuple(
            replace(
                fit,
                energies=np.full(
                    len(fit.energies), error * np.sum(~np.isnan(fit.problem.records.y)) / len(fit.energies)
                ),
            )
            for fit in found.plain.fits
        )

    return make


def test_the_size_is_what_leaving_out_brings_back_of_the_mismatch_beyond_the_noise(fits) -> None:
    """Noise 0.02: a mean square of 4e-4 is nobody's."""
    assert size(fits(1.0), fits(0.5), fits(4e-4), DiagnosisSettings()) == pytest.approx(0.5, rel=1e-2)
    assert size(fits(1.0), fits(0.004), fits(4e-4), DiagnosisSettings()) == pytest.approx(0.0036, rel=2e-2)


def test_a_model_that_does_not_simulate_without_it_leaves_the_whole(fits) -> None:
    assert size(fits(1.0), (), fits(4e-4), DiagnosisSettings()) == 1.0


def test_sizes_are_of_windows_of_one_length(fits) -> None:
    """Over its shortest windows a model may overflow without an effect, and not over the longest."""
    plain, full = fits(1.0), fits(4e-4)
    assert size(plain[1:], plain[1:], full, DiagnosisSettings()) == pytest.approx(1.0, rel=1e-2)
    assert size(plain[1:], fits(0.5)[1:], full[1:], DiagnosisSettings()) == pytest.approx(0.5, rel=1e-2)


def test_lengths_over_which_nothing_is_missing_say_nothing_of_the_size(fits) -> None:
    """Over short windows start states take up what an effect does: neither model leaves more than noise there."""
    noise, settings = 4e-4, DiagnosisSettings()
    plain, full = ((fits(noise)[0], *fits(1.0)[1:]), (fits(1.01 * noise)[0], *fits(noise)[1:]))
    assert size(plain, plain, full, settings) == pytest.approx(1.0, rel=1e-2)
    assert size(fits(noise), fits(noise), fits(1.001 * noise), settings) == 0.0


def test_a_length_over_which_an_effect_does_harm_does_not_outweigh_the_others(fits) -> None:
    """Seen: a stop hit at another instant in two of 48 windows of 280 samples, size minus 1.4; over 1024 samples it removed 93 %."""
    noise, settings = 4e-4, DiagnosisSettings()
    small = fits(2 * noise)[0]
    plain, full = (small, *fits(1.0)[1:]), (fits(6 * noise)[0], *fits(noise)[1:])
    lengths = len(full)
    assert size(plain, plain, full, settings) == pytest.approx((lengths - 1) / lengths, rel=1e-2)
    assert size(fits(1.0), fits(1.0), fits(2.0), settings) == 0.0


def test_a_small_effect_is_a_finding_only_where_others_confirm_it_beyond_chance(dead_zone_search, stub) -> None:
    """Seen: a bias of a thousandth of the mismatch beside an end stop, 0.1 ± 0.05 % of the held-out error."""
    found = dead_zone_search
    effect = Attachment("rotor", ConstantBias())
    name, plain = effect.prefix, found.plain
    state = stub(effects=(effect,), prefixes={name}, plain=plain, current=plain)
    others = stub(times_noise=lambda hypothesis: np.array([1.0]))  # nothing but noise is left
    study = replace(found.study, settings=replace(found.study.settings, least_size_at_noise=1e-3))

    def told(share: float, error: float, of: float) -> bool:
        return not refinements(study, state, others, {name: Gain(share, error, size=of)}, {name: of})

    assert told(0.010, 0.001, 0.002) and not told(0.001, 0.0005, 0.0012)
    assert told(0.5, 0.4, 0.3), "what is large needs no more than any effect does"
    assert not told(0.010, 0.001, 0.0005) and not told(0.5, 0.1, float("nan"))
    assert not refinements(study, state, others, {}, {name: 0.002}), "nobody was asked"


@pytest.mark.parametrize(
    ("before", "parts", "told"),
    [
        (2.0, (0.95,), True),
        (2.0, (0.62,), False),
        (10.0, (0.62,), True),
        (2.0, (0.35, 0.36), False),
        (10.0, (0.35, 0.36), True),
        (2.0, (0.9, 0.1), True),  # the first alone
    ],
)
def test_where_little_is_missing_what_does_not_account_for_most_of_that_is_no_finding(
    dead_zone_search, fits, stub, before: float, parts: tuple[float, ...], told: bool
) -> None:
    """Seen: machines that nothing is missing from, told as a dead time (0.97), a sensor's offset (0.93), a curve over time (0.97) and as a
    curve with a threshold (0.97 each): 15, 3, 62, and 35 and 36 %. Weak effects that are there: 82 to 100.
    """
    noise = 4e-4
    effects = tuple(Attachment("rotor", law) for law in (ConstantBias(), CoulombFriction())[: len(parts)])
    names = [e.prefix for e in effects]
    there = fits(noise * before**2)
    problem = there[0].problem
    values = {**problem.model.values(), "rotor.coulomb_friction.F_c": 1.0}
    plain, found = (stub(error=e, fits=there, problem=problem, values=lambda: values) for e in (before, 1.05))
    state = stub(effects=effects, prefixes=set(names), plain=plain, current=found)
    others = stub(times_noise=lambda h: np.array([1.0, h.error]), fits=lambda h: fits(noise * h.error**2))
    gains, sizes_there = {n: Gain(0.3, 0.01, size=0.3) for n in names}, dict(zip(names, parts, strict=True))
    study = dead_zone_search.study
    little = {n for n, part in sizes_there.items() if before < 3.0 and part < study.settings.least_of_little}
    assert refinements(study, state, others, gains, sizes_there) == little and (little != set(names)) is told
    unexercised = {n: Gain(0.0, 1e-4, size=0.0) for n in names}
    assert not refinements(study, state, others, unexercised, sizes_there), "nothing that could tell"
    assert not refinements(study, state, None, {}, sizes_there)


def test_of_two_laws_of_friction_at_one_body_or_of_one_spring_the_small_one_is_part_of_the_other(
    dead_zone_search, stub
) -> None:
    """Seen: friction with bristles and damping, told as bristles and, 6 % of the mismatch, viscous friction.

    And bristles that fall with speed, told as Stribeck friction, 75 times the noise left, and a ripple of 5 % of the mismatch.
    """
    study, plain = dead_zone_search.study, dead_zone_search.plain

    def told(*attached: tuple[str, Mechanism], small: float, left: float = 1.0, of_the_rest: float = 0.5) -> list[str]:
        effects = tuple(Attachment(port, law) for port, law in attached)
        prefixes = [e.prefix for e in effects]
        state = stub(effects=effects, prefixes=set(prefixes), plain=plain, current=plain)
        others = stub(times_noise=lambda hypothesis: np.array([left]), fits=lambda hypothesis: ())
        gains = {prefixes[1]: Gain(of_the_rest, 0.01, size=small)}
        some = refinements(study, state, others, gains, dict(zip(prefixes, [0.7, small], strict=True)))
        return [p for p in prefixes if p not in some]

    bristles, viscous, bias = ("arm", PreslidingHysteresis()), ("arm", ViscousFriction()), ("arm", ConstantBias())
    assert told(bristles, viscous, small=0.06) == ["arm.presliding_hysteresis"]
    assert len(told(bristles, viscous, small=0.2)) == 2, "too much for what a law lacks"
    assert len(told(bristles, ("motor", ViscousFriction()), small=0.06)) == 2, "of another body"
    assert len(told(bristles, bias, small=0.06)) == 2, "no friction"
    play, bent = ("belt", Backlash()), ("belt", NonlinearStiffness())
    assert told(play, bent, small=0.06) == ["belt.backlash"], (
        "seen: play with soft ends, told with a spring that softens (0.97)"
    )
    assert len(told(play, bent, small=0.2)) == len(told(play, ("shaft", NonlinearStiffness()), small=0.06)) == 2
    assert told(bristles, bias, small=0.06, left=75.0) == ["arm.presliding_hysteresis"], "of a law that lacks something"
    assert len(told(bristles, bias, small=0.06, left=75.0, of_the_rest=0.994)) == 2, (
        "seen: a table's dry friction, 7.8 % beside its weight: without it 24 times what is left"
    )
    assert len(told(bristles, viscous, small=0.06, left=75.0, of_the_rest=0.994)) == 1
    assert len(told(bristles, bias, small=0.2, left=75.0)) == 2
    assert len(told(bristles, ("motor", ConstantBias()), small=0.06, left=75.0)) == 2


def test_what_held_out_experiments_do_not_exercise_is_measured_where_it_was_found(dead_zone_search, fits) -> None:
    found = dead_zone_search
    state = replace(found.state, without={"rotor.x": found.plain})
    idle, seen = Gain(0.0, 1e-4, size=0.0), Gain(0.3, 1e-3, size=0.25)
    assert sizes(found.study, state, {"rotor.x": seen}) == {"rotor.x": 0.25}
    assert sizes(found.study, state, {"rotor.x": idle})["rotor.x"] == pytest.approx(0.0, abs=1e-9)
    assert set(sizes(found.study, state, {})) == {"rotor.x"}


def test_small_effects_are_findings_only_where_noise_alone_is_left(motor, begun, motor_data) -> None:
    data = motor_data()
    found = begun(data, motor)
    others = HeldOut(data, found.study)
    settings = found.study.settings
    assert least_size(found.study, found.state, others) == settings.least_size_at_noise
    wrong = motor_data(acting=lambda v: np.sign(v) * np.maximum(np.abs(v) - 1.0, 0.0))
    missing = begun(wrong, motor)
    assert least_size(missing.study, missing.state, HeldOut(wrong, missing.study)) == settings.least_size


@pytest.mark.parametrize(
    ("sizes_beside", "all_of_it", "taken_back"),
    [((0.001, 0.002), 1.0, "actuator.input_lag"), ((0.001, 0.002), 0.004, None), ((0.001, 0.3), 1.0, None)],
)
def test_of_effects_that_make_up_for_each_other_one_has_to_go(
    dead_zone_search, fits, stub, sizes_beside, all_of_it, taken_back
) -> None:
    """Seen: a delay of 1.2 samples, told as a lag and a delay, each a refinement beside the other: nothing was missing."""
    study, noise = dead_zone_search.study, 4e-4
    effects = (Attachment("actuator", InputLag()), Attachment("actuator", InputDelay()))
    prefixes = {e.prefix for e in effects}
    plain, full = stub(fits=fits(1.0)), stub(fits=fits(noise + (1 - all_of_it) * (1.0 - noise)))
    state = stub(effects=effects, prefixes=prefixes, plain=plain, current=full, without=dict.fromkeys(prefixes))
    gains = {e.prefix: Gain(0.7, 0.01, size=s) for e, s in zip(effects, sizes_beside, strict=True)}
    others = stub(fits=lambda h: h.fits, times_noise=lambda h: np.array([1.0]))
    assert sharing_with_the_rest(study, state, others, gains) == taken_back
    if taken_back is not None:
        alone = stub(**vars(state) | {"effects": effects[1:], "prefixes": {effects[1].prefix}, "without": {}})
        assert sharing_with_the_rest(study, alone, others, {}) is None


@pytest.mark.parametrize(("of_both", "taken_back"), [(0.5, "actuator.input_lag"), (0.004, None)])
def test_two_that_make_up_for_each_other_beside_a_finding(
    monkeypatch, dead_zone_search, fits, stub, of_both, taken_back
) -> None:
    """Seen: an arm's stop, told at both ends of its gear's spring, each a refinement beside the other and a camera's delay."""
    study, noise = dead_zone_search.study, 4e-4
    lag, delay = Attachment("actuator", InputLag()), Attachment("actuator", InputDelay())
    bias = Attachment("rotor", ConstantBias())
    prefixes = {e.prefix for e in (lag, delay, bias)}
    state = stub(
        effects=(lag, delay, bias),
        prefixes=prefixes,
        plain=stub(fits=fits(1.0)),
        current=stub(fits=fits(noise)),
        without=dict.fromkeys(prefixes),
    )
    asked = []

    def without_both(study, rest, start):
        asked.append(rest)
        return stub(fits=fits(noise + of_both * (1.0 - noise)))

    monkeypatch.setattr(standing, "refitted", without_both)
    sizes = {lag.prefix: 0.001, delay.prefix: 0.002, bias.prefix: 0.3}
    gains = {p: Gain(0.7, 0.01, size=s) for p, s in sizes.items()}
    others = stub(fits=lambda h: h.fits, times_noise=lambda h: np.array([1.0]))
    assert sharing_with_the_rest(study, state, others, gains) == taken_back
    assert asked == [(bias,)]
