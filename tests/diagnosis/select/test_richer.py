"""A ripple that was found is tried with harmonics before another effect is named beside it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis.beliefs import NO_BELIEFS, Beliefs
from greybox_torch.diagnosis.hypothesis.noise import noise_floor
from greybox_torch.diagnosis.refit.ranked import judged
from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.select import richer
from greybox_torch.diagnosis.select.forms import forms
from greybox_torch.diagnosis.select.richer import (
    _pays,
    _preferred,
    richer_instead,
    with_earlier_law_richer,
    with_richer_form,
)
from greybox_torch.diagnosis.select.state import SelectionStep
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.mechanisms.actuator import InputDelay, InputGain, InputLag
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.presliding import PreslidingHysteresis
from greybox_torch.mechanisms.sensor import OutputDelay, SensorBias, SensorLag
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.mechanisms.varying_friction import PositionDependentFriction

from ..conftest import STEP, found, turned


@pytest.mark.parametrize(("strong", "weak"), [(1, 2), (2, 3)])
def test_harmonics_join_the_ripple_whichever_is_the_strongest(motor_data, motor, begun, strong, weak) -> None:
    """Seen: cogging of a wrist at 2, 4 and 6 periods a turn, told as something missing without a name."""
    size = {strong: 0.06, weak: 0.03}
    search = begun(motor_data(torque=lambda q, v: sum(f * np.sin(2.5 * k * q) for k, f in size.items())), motor)
    ripple = attach(motor, "rotor", TorqueRipple(2.5 * strong))
    before = found(search, ripple, {f"{ripple.prefix}.b": 0.06})
    state = result_of(with_richer_form(search.study, before))
    (effect,) = state.effects
    assert isinstance(effect.mechanism, TorqueRipple) and effect.mechanism.harmonics > 1
    values = {n.removeprefix(f"{ripple.prefix}."): v for n, v in state.current.values().items()}
    base = round(values["order"] / 2.5, 1)
    assert base in (1.0, strong / 2, strong) and weak / base == int(weak / base)
    for k, f in size.items():
        which = "" if k == base else f"_{int(k / base)}"
        assert np.hypot(values[f"a{which}"], values[f"b{which}"]) == pytest.approx(f, rel=0.1)
    (step,) = state.steps
    assert step.taken is not None and step.taken.candidate.attachment == effect and step.taken.fitted is state.current
    assert step.taken.gain == pytest.approx(search.plain.score - state.current.score), "as its rivals' gains are"


def test_what_has_no_richer_form_or_leaves_noise_alone_stays_as_it_is(motor_data, motor, begun) -> None:
    search = begun(motor_data(torque=lambda q, v: 0.06 * np.sin(2.5 * q)), motor)
    ripple, dry = attach(motor, "rotor", TorqueRipple(2.5)), attach(motor, "rotor", CoulombFriction())
    for effect, start in ((ripple, {f"{ripple.prefix}.b": 0.06}), (dry, {f"{dry.prefix}.F_c": 0.01})):
        before = found(search, effect, start)
        assert result_of(with_richer_form(search.study, before)) is before


def test_an_earlier_law_is_asked_once_more_where_no_further_effect_pays(motor_data, motor, begun) -> None:
    """Seen: the bump stops of a vehicle, told as a curve beside the delay of a sensor."""
    torque = {1: 0.06, 2: 0.03}
    data = motor_data(torque=lambda q, v: 0.2 + sum(f * np.sin(2.5 * k * q) for k, f in torque.items()))
    search = begun(data, motor)
    ripple, bias = attach(motor, "rotor", TorqueRipple(2.5)), attach(motor, "rotor", ConstantBias())
    first = found(search, ripple, {f"{ripple.prefix}.b": 0.06})
    both = search.refitted((ripple, bias), first.current)
    taken = judged(Candidate(bias, (), 0.5), first.current, both, search.study.settings)
    state = replace(first.at(both), steps=(*first.steps, SelectionStep((), first.current, (taken,), taken)))
    asked = result_of(with_earlier_law_richer(search.study, state))
    assert [e.prefix for e in asked.effects] == [ripple.prefix, bias.prefix]
    assert asked.effects[0].mechanism.harmonics > 1 and asked.current.score < state.current.score
    assert result_of(with_earlier_law_richer(search.study, first)) is first, "the newest has been asked"


@pytest.mark.parametrize(("plain", "left", "taken"), [(20.0, 1.05, True), (20.0, 9.0, False), (1.5, 0.9, False)])
def test_what_it_takes_up_is_asked_where_the_law_leaves_most(motor_data, motor, begun, plain, left, taken) -> None:
    """Seen: cogging of two orders along a rail; over all but the longest windows one order left little more than an encoder's steps."""
    search = begun(motor_data(torque=lambda q, v: 0.06 * np.sin(2.5 * q)), motor)
    ripple = attach(motor, "rotor", TorqueRipple(2.5))
    state, settings = found(search, ripple, {f"{ripple.prefix}.b": 0.06}), search.study.settings
    fitted = state.current
    floors = [noise_floor(f.problem, settings) for f in fitted.fits]

    def leaving(*times: float) -> Any:
        fits = [replace(f, mean_square=t * n) for f, t, n in zip(fitted.fits, times, floors, strict=True)]
        return replace(fitted, fits=tuple(fits))

    before, after = leaving(1.0, 1.1, plain), leaving(1.0, 1.05, left)
    ranked = replace(judged(Candidate(ripple, (), 0.5), before, after, settings), significance=5.0)
    assert ranked.gain < -np.log1p(-settings.least_of_richer_form)
    assert _pays(search.study, state.at(before), ranked) is taken


@pytest.mark.parametrize(("beyond", "instead"), [(-0.5, True), (0.01, True), (0.5, False)])
def test_a_richer_form_is_asked_once_more_when_another_law_comes_to_its_port(
    motor_data, motor, begun, beyond, instead
) -> None:
    """Seen: a second harmonic of cogging, too little to see beside a rubber coupling, told as friction that depends on position."""
    search = begun(motor_data(torque=lambda q, v: 0.06 * np.sin(2.5 * q) + 0.03 * np.sin(5.0 * q)), motor)
    ripple = attach(motor, "rotor", TorqueRipple(2.5))
    before = found(search, ripple, {f"{ripple.prefix}.b": 0.06})
    (effect,) = result_of(with_richer_form(search.study, before)).effects
    reached = search.refitted((effect,), before.current, [before.current.values()]).score

    def after(port: str) -> Any:
        other = attach(motor, port, CoulombFriction() if port == "rotor" else InputGain())
        factor = np.exp(reached - beyond - before.current.score)
        fits = tuple(replace(f, mean_square=factor * f.mean_square) for f in before.current.fits)
        fitted = replace(before.current, effects=(ripple, other), fits=fits)
        step = SelectionStep(
            (), before.current, (), judged(Candidate(other, (), 0.5), before.current, fitted, search.study.settings)
        )
        return replace(before.at(fitted), steps=(*before.steps, step))

    state = richer_instead(search.study, before, after("rotor"))
    assert (state is not None) is instead
    if state is not None:
        (law,) = state.effects
        assert law.mechanism.options() == effect.mechanism.options() and law.mechanism.harmonics > 1
        (step,) = state.steps
        assert step.taken is not None and step.taken.candidate.attachment == law
        assert state.current.score == pytest.approx(reached, abs=1e-3)
    assert richer_instead(search.study, before, after("actuator")) is None


def filtered(speed: np.ndarray, time: float, damping: float, step: float, parts: int = 50) -> np.ndarray:
    """A speed (N,) through a filter of second order with a mean delay; Euler steps, fine, the speed linear between samples."""
    omega, h = 2 * damping / time, step / parts
    shown, slope, recorded = speed[0], 0.0, []
    for now, then in zip(speed, np.append(speed[1:], speed[-1]), strict=True):
        recorded.append(shown)
        for k in range(parts):
            true = now + (then - now) * k / parts
            slope += h * (omega**2 * (true - shown) - 2 * damping * omega * slope)
            shown += h * slope
    return np.array(recorded)


@pytest.mark.parametrize("taken", [OutputDelay(), SensorLag()])
def test_a_filter_of_second_order_is_found_behind_a_delay_or_a_lag(data_set, motor, motor_speed, begun, taken) -> None:
    """Seen: a flow meter with a filter of second order told as a delay (0.97)."""
    rng, time, damping = np.random.default_rng(0), 0.12, 0.7
    voltage = np.repeat(rng.uniform(-3, 3, 100), 20)
    speed = filtered(motor_speed(voltage, start=0.3), time, damping, STEP) + rng.normal(0, 0.01, 2000)
    data = data_set({"voltage": "V", "speed": "rad/s"}, [{"voltage": voltage, "speed": speed}], sample_time=STEP)
    search, effect = begun(data, motor), attach(motor, "sensor", taken)
    state = result_of(with_richer_form(search.study, found(search, effect, {f"{effect.prefix}.T": time})))
    (law,) = state.effects
    assert law.named == ("sensor", "sensor_lag") and law.mechanism.options() == {"second_order": True}
    values = state.current.values()
    assert values[f"{law.prefix}.T"] == pytest.approx(time, rel=0.03)
    assert values[f"{law.prefix}.damping"] == pytest.approx(damping, rel=0.05)
    both = replace(state, current=replace(state.current, effects=(effect, attach(motor, "sensor", SensorLag()))))
    if isinstance(taken, OutputDelay):
        assert not list(forms(effect, both, NO_BELIEFS)), "there is a lag at the sensor already"
    dry = attach(motor, "sensor", SensorBias())
    assert not list(forms(dry, found(search, dry, {f"{dry.prefix}.bias": 0.0}), NO_BELIEFS))


@pytest.mark.parametrize(
    ("left", "little", "alone", "taken"),
    [(0.85, False, False, False), (0.4, False, False, True), (0.4, True, False, False), (0.4, True, True, True)],
)
def test_under_another_name_a_form_has_to_leave_less_than_half(
    motor_data, motor, begun, monkeypatch, left, little, alone, taken
) -> None:
    """Seen: a delay of 1.2 samples, told as a lag of second order that left 15 % less, and then as both.

    Where little is left, it has to leave noise alone: a truck's dead time, 0.8 % left, was told as a lag of second order (0.3 %).
    """
    search, delay = begun(motor_data(), motor), attach(motor, "actuator", InputDelay())
    state = found(search, delay, {f"{delay.prefix}.T": STEP})
    before, lag = state.current, attach(motor, "actuator", InputLag(True))
    monkeypatch.setattr(richer, "remaining_share", lambda *args: 0.008 if little else 0.5)
    monkeypatch.setattr(richer, "completes", lambda fitted, settings: alone and fitted is not before)
    there = found(search, lag, {f"{lag.prefix}.T": STEP, f"{lag.prefix}.damping": 1.0}).current
    pairs = zip(there.fits, before.fits, strict=True)
    after = replace(there, fits=tuple(replace(f, mean_square=left * b.mean_square) for f, b in pairs))
    ranked = replace(judged(Candidate(lag, (), 0.5), before, after, search.study.settings), significance=9.0)
    assert ranked.gain == pytest.approx(-np.log(left), abs=1e-3)
    assert _preferred(search.study, state, delay, ranked) is taken


def test_friction_along_a_turn_that_never_reverses_is_asked_as_a_ripple_with_harmonics(data_set, motor, begun) -> None:
    """Seen: a spindle's cogging of orders 8, 16 and 24, always forward, told as friction that depends on position."""
    rng, cogging = np.random.default_rng(0), {1: 0.04, 2: 0.02, 3: 0.01}
    voltage = np.repeat(rng.uniform(2, 6, 100), 20)
    speed = turned(voltage, lambda q, v: sum(f * np.sin(2.5 * k * q) for k, f in cogging.items()))
    record = {"voltage": voltage, "speed": speed + rng.normal(0, 0.02, 2000)}
    search = begun(data_set({"voltage": "V", "speed": "rad/s"}, [record], sample_time=STEP), motor)
    effect = attach(motor, "rotor", PositionDependentFriction(2.5))
    before = found(search, effect, {f"{effect.prefix}.b": -0.04})
    (law,) = result_of(with_richer_form(search.study, before)).effects
    assert law.named == ("rotor", "torque_ripple")
    assert isinstance(law.mechanism, TorqueRipple) and law.mechanism.harmonics == 3


def test_friction_along_a_turn_that_reverses_is_asked_with_harmonics(motor_data, motor, begun) -> None:
    """Seen: bumps of a press cylinder's friction, told as friction that depends on position at three bodies (orders 1, 2 and 3)."""

    def rubbing(q: float, v: float) -> float:
        return -(0.06 * np.sin(2.5 * q) + 0.04 * np.cos(5.0 * q) + 0.03 * np.sin(7.5 * q)) * np.tanh(v / 0.2)

    search = begun(motor_data(torque=rubbing), motor)
    effect = attach(motor, "rotor", PositionDependentFriction(2.5))
    before = found(search, effect, {f"{effect.prefix}.b": 0.06})
    state = result_of(with_richer_form(search.study, before))
    (law,) = state.effects
    assert law.named == ("rotor", "position_dependent_friction")
    assert law.mechanism.options()["harmonics"] == 3
    values = {n.removeprefix(f"{law.prefix}."): v for n, v in state.current.values().items()}
    assert values["order"] == pytest.approx(2.5, rel=0.01)
    for k, size in {"": 0.06, "_2": 0.04, "_3": 0.03}.items():
        assert np.hypot(values[f"a{k}"], values[f"b{k}"]) == pytest.approx(size, rel=0.15)


def test_a_law_that_contains_what_was_found_is_asked_where_it_was_no_rival(motor_data, motor, begun) -> None:
    """Seen: the bristles of a capstan, told as Coulomb friction (0.85), which left 140 times the noise: no probe had their length."""
    search = begun(motor_data(torque=lambda q, v: -0.06 * np.tanh(v / 0.2)), motor)
    dry, bristles = attach(motor, "rotor", CoulombFriction()), attach(motor, "rotor", PreslidingHysteresis())
    state = found(search, dry, {f"{dry.prefix}.F_c": 0.06})
    asked = {law.mechanism.name: start for law, start in forms(dry, state, NO_BELIEFS)}
    assert {"coulomb_asymmetry", "presliding_hysteresis"} <= set(asked)
    level = state.current.values()[f"{dry.prefix}.F_c"]
    assert asked["presliding_hysteresis"][f"{bristles.prefix}.F"] == level
    (step,) = state.steps
    rival = replace(step.taken, candidate=Candidate(bristles, (), 0.1))
    beside = replace(state, steps=(replace(step, ranked=(*step.ranked, rival)),))
    assert "presliding_hysteresis" not in {law.mechanism.name for law, _ in forms(dry, beside, NO_BELIEFS)}
    excluded = Beliefs({"rotor/presliding_hysteresis": 0.0, "*/coulomb_asymmetry": 0.0})
    left = {law.mechanism.name for law, _ in forms(dry, state, excluded)}
    assert left == set(asked) - {"presliding_hysteresis", "coulomb_asymmetry"}
