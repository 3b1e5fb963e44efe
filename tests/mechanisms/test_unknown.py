from __future__ import annotations

import numpy as np
import pytest
import torch

from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Signals


def test_follows_any_smooth_curve_over_its_range(law, around) -> None:
    curve = Unknown("speed")
    span = around.ranges["speed"]
    speed = np.linspace(span.low, span.high, 300)
    bumps = np.stack([law(curve, {f"w_{k}": 1.0}, speed=speed) for k in range(14)], axis=1)
    for target in (np.tanh(speed / 4), 0.01 * speed**2, np.exp(-((speed / 5) ** 2))):
        heights = np.linalg.lstsq(bumps, target, rcond=None)[0]
        fitted = law(curve, {f"w_{k}": float(h) for k, h in enumerate(heights)}, speed=speed)
        assert np.std(fitted - target) < 0.05 * np.std(target)


def test_centres_span_the_range_and_do_not_move(around) -> None:
    curve = Unknown("deflection", knots=5)
    centres = curve.centres(around)
    assert (centres[1], centres[-2]) == pytest.approx(
        (around.ranges["deflection"].low, around.ranges["deflection"].high)
    )
    np.testing.assert_allclose(np.diff(centres), np.diff(centres)[0])
    fixed = {p.name: p for p in curve.parameters(around) if p.fixed}
    assert set(fixed) == {"first", "spacing"}
    heights = [p.description for p in curve.parameters(around) if not p.fixed]
    assert heights[1] == f"height at deflection = {centres[1]:g} rad"  # seen: "height at 53.6364"
    assert fixed["first"].description == "first centre over deflection"
    assert fixed["first"].unit == "rad" and fixed["spacing"].value == pytest.approx(0.11 / 2)


def test_signal_of_the_curve_is_what_it_is_told() -> None:
    assert Unknown("input").signals() == ("input",)


def test_a_curve_with_a_factor_is_a_gain_that_changes(law, around, anywhere) -> None:
    gain, force = Unknown("time", 6, "input"), Unknown("time", 6)
    heights = {f"w_{k}": 0.1 * k for k in range(6)}
    time, u = anywhere["time"], anywhere["input"]
    np.testing.assert_allclose(law(gain, heights, time=time, input=u), u * law(force, heights, time=time))
    assert gain.signals() == ("time", "input")
    assert {p.unit for p in gain.parameters(around) if p.shrunk} == {""}
    assert law(gain, heights, time=time) == pytest.approx(law(force, heights, time=time)), (
        "without the factor: the gain itself"
    )


@pytest.mark.parametrize(
    ("signal", "factor", "unit", "reads"),
    [
        ("speed", "", "N m", ()),
        ("time", "input", "", ()),
        ("position", "speed", "N m/(rad/s)", ()),
        ("position", "input@q", "N m/(Pa)", ("input@q",)),
        ("position@pitch", "", "N m", ("position@pitch",)),
        ("position@pitch", "input@q", "N m/(Pa)", ("position@pitch", "input@q")),
    ],
)
def test_heights_have_the_unit_of_what_turns_the_factor_into_a_force(signal, factor, unit, reads) -> None:
    ranges = dict.fromkeys(("speed", "position", "time", "position@pitch"), Range(-1.0, 1.0, 0.5))
    around = Surroundings(ranges, {"speed": "rad/s", "input@q": "Pa"}, "N m", 1e-3)
    curve = Unknown(signal, 6, factor)
    assert {p.unit for p in curve.parameters(around) if p.shrunk} == {unit}
    assert curve.reads == reads
    assert Unknown(**curve.options()).reads == curve.reads


def test_bumps_that_are_left_out_are_zero_and_have_no_parameters(law, around) -> None:
    sparse, whole = Unknown("speed", 8, left_out=(0, 3, 7)), Unknown("speed", 8)
    span = around.ranges["speed"]
    speed = np.linspace(span.low, span.high, 50)
    heights = {f"w_{k}": 0.1 * (k + 1) for k in sparse.bumps}
    zeros = {f"w_{k}": 0.0 for k in (0, 3, 7)}
    np.testing.assert_allclose(law(sparse, heights, speed=speed), law(whole, heights | zeros, speed=speed))
    assert sparse.bumps == [1, 2, 4, 5, 6] and sparse.probes(around)[0].directions == tuple(heights)
    assert {p.name for p in sparse.parameters(around)} == {*heights, "first", "spacing"}
    assert Unknown(**sparse.options()).bumps == sparse.bumps


@pytest.mark.parametrize(
    ("knots", "left_out"), [(5, ()), (14, ()), (41, (0, 4, 9, 10, 11, 12, 13, 14, 15, 16, 17, 40))]
)
@pytest.mark.parametrize("precision", [torch.float64, torch.float32])
def test_bumps_are_the_same_whichever_exponentials_they_are_computed_from(knots, left_out, precision) -> None:
    curve, rng = Unknown("speed", knots, left_out=left_out), np.random.default_rng(knots)
    heights = {
        f"w_{k}": torch.tensor(h, dtype=precision) for k, h in zip(curve.bumps, rng.normal(size=knots), strict=False)
    }
    speed = torch.linspace(-0.5 * knots, 1.5 * knots, 997, dtype=precision, requires_grad=True)
    signals = Signals("signal", {"speed": speed})
    values = curve.curve(signals, Signals("parameter", {**heights, "first": torch.tensor(0.0), "spacing": 1.0}))
    place = torch.clamp(speed, 1.0, knots - 2.0)
    plain = sum(heights[f"w_{k}"] * torch.exp(-((place - k) ** 2)) for k in curve.bumps)
    tolerance = 1e-13 if precision is torch.float64 else 1e-4
    slopes = [torch.autograd.grad(y.sum(), speed)[0] for y in (values, plain)]
    torch.testing.assert_close(values, plain, rtol=tolerance, atol=tolerance)
    torch.testing.assert_close(*slopes, rtol=tolerance, atol=tolerance)
