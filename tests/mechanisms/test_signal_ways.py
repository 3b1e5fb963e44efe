"""The ways of signals in and out: actuators and sensors. Their law is the change of the signal."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from greybox_torch.mechanisms.actuator import InputBias, InputDelay, InputGain, InputLag, TorqueSaturation
from greybox_torch.mechanisms.actuator_deadzone import ActuatorDeadzone
from greybox_torch.mechanisms.sensor import OutputDelay, SensorBias, SensorGain, SensorLag

INPUT = np.linspace(-5.0, 5.0, 101)


def test_saturation_clips(law) -> None:
    acting = INPUT + law(TorqueSaturation(), {"limit": 2.0}, input=INPUT)
    np.testing.assert_allclose(acting, np.clip(INPUT, -2.0, 2.0), atol=1e-15)


def test_a_soft_saturation_bends_over(law) -> None:
    """The same limit and slope at zero, u / (1 + |u / L|^n)^(1/n) in between; a softness of next to nothing is a clamp."""
    acting = INPUT + law(TorqueSaturation(), {"limit": 2.0, "softness": 0.5}, input=INPUT)
    np.testing.assert_allclose(acting, INPUT / np.sqrt(1 + (INPUT / 2.0) ** 2), rtol=1e-9, atol=1e-12)
    nearly = INPUT + law(TorqueSaturation(), {"limit": 2.0, "softness": 1e-4}, input=INPUT)
    np.testing.assert_allclose(nearly, np.clip(INPUT, -2.0, 2.0), atol=2e-4)


def test_limits_and_dead_bands_may_differ_by_direction(law) -> None:
    limited = INPUT + law(TorqueSaturation(True), {"limit": 2.0, "asymmetry": -0.25}, input=INPUT)
    np.testing.assert_allclose(limited, np.clip(INPUT, -2.5, 1.5), atol=1e-15)
    dead = INPUT + law(ActuatorDeadzone(True), {"half_width": 1.0, "asymmetry": 0.5}, input=INPUT)
    np.testing.assert_allclose(dead, INPUT - np.clip(INPUT, -0.5, 1.5), atol=1e-15)


def test_beyond_the_base_speed_a_limit_falls_at_constant_power(law) -> None:
    speed = np.linspace(-6.0, 6.0, len(INPUT))
    limited = INPUT + law(
        TorqueSaturation(limited_power=True), {"limit": 2.0, "base_speed": 1.5}, input=INPUT, speed=speed
    )
    most = np.minimum(2.0, 3.0 / np.maximum(np.abs(speed), 1e-9))
    np.testing.assert_allclose(limited, np.clip(INPUT, -most, most), atol=1e-14)
    both = INPUT + law(
        TorqueSaturation(True, True), {"limit": 2.0, "asymmetry": 0.25, "base_speed": 1.5}, input=INPUT, speed=speed
    )
    np.testing.assert_allclose(both, np.clip(INPUT, -0.75 * most, 1.25 * most), atol=1e-14)


def test_a_limit_has_every_richer_form_once(around) -> None:
    """Seen: a car's wheel force, 3400 N or 60 kW, told as something without a name, as free runs took back the limit alone."""
    forms = [form.options() for form, _ in TorqueSaturation().richer({"limit": 1.0})]
    assert [tuple(f.values()) for f in forms] == [(True, False), (False, True), (True, True)]
    assert [tuple(f.options().values()) for f, _ in TorqueSaturation(False, True).richer({"limit": 1.0})] == [
        (True, True)
    ]
    assert not TorqueSaturation(True, True).richer({"limit": 1.0})
    (speed,) = (p for p in TorqueSaturation(False, True).parameters(around) if p.name == "base_speed")
    assert speed.bounds[1] == around.ranges["speed"].reach and speed.unit == around.units["speed"]


@pytest.mark.parametrize("plain", [TorqueSaturation(), ActuatorDeadzone()])
def test_the_form_by_direction_is_asked_where_a_curve_is_not_odd_or_more_than_noise_is_left(law, around, plain) -> None:
    signals, weight = {"input": torch.as_tensor(np.sort(INPUT))}, np.ones(len(INPUT))
    amplitude = "limit" if isinstance(plain, TorqueSaturation) else "half_width"
    for asymmetry in (0.0, 0.4):
        values = {amplitude: 1.0, "asymmetry": asymmetry}
        drawn = law(type(plain)(True), values, input=np.sort(INPUT))
        assert plain.nearest(around, signals, drawn, weight).options()["by_direction"] == (asymmetry > 0.0)
    (form, begun), *others = plain.richer({amplitude: 1.0})
    assert form.options()["by_direction"] and begun == {amplitude: 1.0, "asymmetry": 0.0}
    assert len(others) == 2 and len(form.richer(begun)) == 1, "with limited power or round corners, alone and besides"


def test_dead_zone_of_the_actuator(law) -> None:
    acting = INPUT + law(ActuatorDeadzone(), {"half_width": 1.0}, input=INPUT)
    np.testing.assert_allclose(acting, np.sign(INPUT) * np.maximum(np.abs(INPUT) - 1.0, 0.0), atol=1e-14)


def test_round_corners_of_a_dead_zone(law) -> None:
    soft = {"half_width": 0.8, "softness": 0.5}
    acting = INPUT + law(ActuatorDeadzone(soft=True), soft, input=INPUT)
    np.testing.assert_allclose(acting, INPUT - INPUT / np.hypot(1.0, INPUT / 0.8), atol=1e-12)
    sharp = INPUT + law(ActuatorDeadzone(True, True), {**soft, "softness": 0.0, "asymmetry": 0.25}, input=INPUT)
    np.testing.assert_allclose(sharp, INPUT - np.clip(INPUT, -0.6, 1.0), atol=1e-11)


def test_a_dead_zone_has_every_richer_form_once_and_goes_back_by_steps() -> None:
    forms = [(tuple(form.options().values()), begun) for form, begun in ActuatorDeadzone().richer({"half_width": 1.0})]
    asymmetry, softness = {"asymmetry": 0.0}, {"softness": 0.3}
    width = {"half_width": 1.0}
    assert forms == [
        ((True, False), asymmetry | width),
        ((False, True), softness | width),
        ((True, True), asymmetry | softness | width),
    ]
    assert not ActuatorDeadzone(True, True).richer(width)
    law, values = ActuatorDeadzone(True, True), asymmetry | softness | width
    for options, left in (((False, True), softness | width), ((False, False), width)):
        plainer = law.plainer(values)
        assert plainer is not None
        law, values = plainer
        assert tuple(law.options().values()) == options and values == left
    assert law.plainer(values) is None


@pytest.mark.parametrize(("bias", "signal"), [(InputBias(), "input"), (SensorBias(), "output")])
def test_bias(law, bias, signal) -> None:
    np.testing.assert_allclose(law(bias, {"bias": 0.3}, **{signal: INPUT}), 0.3)


@pytest.mark.parametrize(("gain", "signal"), [(InputGain(), "input"), (SensorGain(), "output")])
def test_gain(law, gain, signal) -> None:
    np.testing.assert_allclose(law(gain, {"gain_error": -0.2}, **{signal: INPUT}), -0.2 * INPUT)


@pytest.mark.parametrize(("lag", "signal"), [(InputLag(), "input"), (SensorLag(), "output")])
def test_lag_settles_to_its_signal_with_its_time_constant(law, rates, lag, signal) -> None:
    lagged, after = 0.0, {}
    for k in range(20_000):
        now = {signal: np.array(3.0), "sample_time": np.array(1e-4)}
        after[k] = 3.0 + float(law(lag, {"T": 0.1}, {"lagged": np.array(lagged)}, **now))
        lagged += 1e-4 * float(rates(lag, {"T": 0.1}, {"lagged": np.array(lagged)}, **now)[0])
        if k > 1000:
            break
    assert after[0] == 0.0
    assert after[1000] == pytest.approx(3.0 * (1 - np.exp(-1.0)), rel=1e-3)
    settled = law(lag, {"T": 0.1}, {"lagged": np.array(3.0)}, **now)
    assert settled == 0.0


@pytest.mark.parametrize("kind", [InputLag, SensorLag])
@pytest.mark.parametrize("damping", [0.5, 1.0, 1.5])
def test_a_lag_of_second_order_follows_a_step_as_the_analytic_solution_does(law, rates, kind, damping) -> None:
    """T is the mean delay: the area between the step and what is recorded of it."""
    lag, time, h = kind(True), 0.1, 4e-4
    values, signal = {"T": time, "damping": damping}, lag.needs[0]
    omega = 2 * damping / time
    z, followed = np.zeros(2), []
    for _ in range(3000):
        now = {signal: np.array(1.0), "sample_time": np.array(h)}
        memory = {"lagged": z[:1], "slope": z[1:]}
        followed.append(1.0 + float(law(lag, values, memory, **now)[0]))
        middle = z + 0.5 * h * np.ravel(rates(lag, values, memory, **now))
        z = z + h * np.ravel(rates(lag, values, {"lagged": middle[:1], "slope": middle[1:]}, **now))
    t = h * np.arange(3000)
    poles = omega * (-damping + np.array([1, -1]) * np.sqrt(complex(damping**2 - 1) + 1e-12))
    response = 1 + np.real((poles[1] * np.exp(poles[0] * t) - poles[0] * np.exp(poles[1] * t)) / (poles[0] - poles[1]))
    np.testing.assert_allclose(followed, response, atol=2e-4)
    assert h * np.sum(1.0 - np.array(followed)) == pytest.approx(time, rel=1e-2)


@pytest.mark.parametrize(("kind", "delay"), [(InputLag, InputDelay), (SensorLag, OutputDelay)])
def test_a_lag_of_second_order_is_asked_for_a_lag_and_for_a_delay(kind, delay) -> None:
    for plain in (kind(), delay()):
        ((form, begun),) = plain.richer({"T": 0.02})
        assert form.name == kind.name and form.options() == {"second_order": True}
        assert begun == {"T": 0.02, "damping": 1.0} and not form.richer(begun)
    assert not InputDelay(("other",)).richer({"T": 0.02}), "all inputs are late together"


def test_delay_acts_by_the_delayed_input(law) -> None:
    acting = INPUT + law(InputDelay(), {"T": 0.01}, input=INPUT, delayed=INPUT - 0.4)
    np.testing.assert_allclose(acting, INPUT - 0.4)


def test_a_form_by_direction_is_not_asked_of_one_direction_nor_in_the_order_of_the_samples(law, around) -> None:
    """A one-sided input tells nothing of the other side; samples of a record come in the order of time."""
    above, rng = np.linspace(0.0, 5.0, 101), np.random.default_rng(2)
    for signal, values in (
        (above, {"limit": 2.0}),
        (above - 0.1, {"limit": 2.0}),
        (rng.permutation(INPUT), {"limit": 2.0}),
    ):
        drawn = law(TorqueSaturation(), values, input=signal) + 1e-3
        form = TorqueSaturation().nearest(around, {"input": torch.as_tensor(signal)}, drawn, np.ones(len(signal)))
        assert not form.options()["by_direction"]
    mixed = rng.permutation(INPUT)
    drawn = law(TorqueSaturation(True), {"limit": 2.0, "asymmetry": 0.4}, input=mixed)
    form = TorqueSaturation().nearest(around, {"input": torch.as_tensor(mixed)}, drawn, np.ones(len(mixed)))
    assert form.options()["by_direction"]
