"""Forces on a body that are no friction, and terms of a balance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.mechanisms.balance import LinearLeak, ThresholdFlow
from greybox_torch.mechanisms.end_stop import EndStop
from greybox_torch.mechanisms.forces import AdditionalMode, ConstantBias
from greybox_torch.mechanisms.gravity import Gravity
from greybox_torch.mechanisms.surroundings import Range, Surroundings
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.mechanisms.transmission_error import TransmissionError
from greybox_torch.mechanisms.varying_friction import PositionDependentFriction

ANGLES = np.linspace(-4.0, 4.0, 201)


def test_bias_is_constant(law) -> None:
    assert (law(ConstantBias(), {"bias": -0.7}, speed=ANGLES) == -0.7).all()


def test_gravity_once_per_turn_and_pulls_back_to_hanging(law) -> None:
    weight = law(Gravity(), {"a": 2.0, "b": 0.0}, position=ANGLES)
    np.testing.assert_allclose(weight, -2.0 * np.sin(ANGLES))
    leaning = {"a": 2.0, "b": 1.0}
    here, a_turn_on = (law(Gravity(), leaning, position=ANGLES + turn) for turn in (0.0, 2 * np.pi))
    np.testing.assert_allclose(here, a_turn_on, atol=1e-12)


@pytest.mark.parametrize("order", [2.0, 7.3])
def test_ripple_is_periodic_with_its_order_and_no_other(law, order) -> None:
    values = {"a": 0.3, "b": -0.4}
    here, on, half = (
        law(TorqueRipple(order), values, position=ANGLES + shift * 2 * np.pi / order) for shift in (0.0, 1.0, 0.5)
    )
    np.testing.assert_allclose(here, on, atol=1e-12)
    np.testing.assert_allclose(here, -half, atol=1e-12)
    assert np.abs(here).max() == pytest.approx(0.5, rel=0.01)


def test_richer_forms_of_a_ripple_begin_as_the_ripple_found(law) -> None:
    values = {"a": 0.3, "b": -0.7, "order": 6.0}
    plain = law(TorqueRipple(6.0), values, position=ANGLES)
    forms = TorqueRipple(6.0).richer(values)
    assert [(form.order, form.harmonics) for form, _ in forms] == [(6.0, 3), (3.0, 6), (2.0, 6)]
    for form, begun in forms:
        np.testing.assert_allclose(law(form, begun, position=ANGLES), plain, atol=1e-14)
        assert form.richer(begun) == ()


def test_harmonics_of_a_ripple(law) -> None:
    force = law(TorqueRipple(2.0, 3), {"a": 0.1, "b_2": 0.2, "a_3": 0.3, "order": 2.0}, position=ANGLES)
    np.testing.assert_allclose(
        force, 0.1 * np.cos(2 * ANGLES) + 0.2 * np.sin(4 * ANGLES) + 0.3 * np.cos(6 * ANGLES), atol=1e-14
    )


@pytest.mark.parametrize(("side", "end"), [(1.0, 5.0), (-1.0, -3.0)])
def test_a_stop_is_begun_stiffer_and_hard_at_the_end_of_the_travel(side, end) -> None:
    """Seen: a cart's stop of 9000 N/m, to which no refit came from 3 N/m."""
    around = Surroundings({"position": Range(-3.0, 5.0, 2.0)}, {"position": "rad"}, "N m", 1e-3)
    found = {"k": 2.0, "where": 4.0 * side, "c": 0.1, "side": side}
    assert list(EndStop().begun_elsewhere(around, found)) == [{"k": 60.0}, {"k": 2000.0, "where": end}]


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_end_stop_pushes_back_beyond_and_is_absent_before(law, side) -> None:
    force = law(EndStop(), {"k": 10.0, "where": 1.0, "side": side}, position=ANGLES, speed=np.zeros_like(ANGLES))
    beyond = side * (ANGLES - 1.0)
    assert (force[beyond <= 0] == 0).all()
    np.testing.assert_allclose(force[beyond > 0], -side * 10.0 * beyond[beyond > 0])
    assert (force * side <= 0).all()


MODE = {"mass": 0.5, "omega": 30.0, "zeta": 0.1}


def test_additional_mode_reacts_with_what_accelerates_its_mass(law, rates, anywhere) -> None:
    memory = {"stretch": anywhere["deflection"], "speed": np.flip(anywhere["speed"]).copy()}
    force = law(AdditionalMode(), MODE, memory, speed=anywhere["speed"])
    np.testing.assert_allclose(force, -0.5 * rates(AdditionalMode(), MODE, memory, speed=anywhere["speed"])[1])


def test_looks_at_a_mode_lie_within_the_width_of_a_resonance_of_a_few_percent_damping() -> None:
    """Seen: modes of 57 and 64 rad/s and 3 % damping, from 47 and 69 rad/s not found: "unknown at the actuator" (0.73), and no answer."""
    around = Surroundings({"speed": Range(-3.0, 5.0, 2.0)}, {"speed": "rad/s"}, "N m", 1e-3)
    looked_at = np.array([probe.values["omega"] for probe in AdditionalMode().probes(around)])
    assert looked_at[[0, -1]] / (1e3 * np.pi) == pytest.approx([0.002, 0.11])
    assert (np.diff(np.log(looked_at)) < 0.17).all()


@pytest.mark.parametrize(("omega", "others"), [(30.0, [10.0, 90.0]), (1.5, [4.5]), (600.0, [200.0])])
def test_a_mode_is_begun_half_a_decade_away_within_its_bounds(omega, others) -> None:
    """Seen: a motor's mode of 93 rad/s, refitted from 31 rad/s, stayed there; one at the arm, beyond the excited band, was told (0.85)."""
    around = Surroundings({"speed": Range(-3.0, 5.0, 2.0)}, {"speed": "rad/s"}, "N m", 1e-3)
    found = AdditionalMode().begun_elsewhere(around, {"mass": 0.5, "omega": omega, "zeta": 0.3})
    assert [v["omega"] for v in found] == pytest.approx(others) and {v["zeta"] for v in found} == {0.05}


def test_additional_mode_is_a_mass_to_slow_motion_and_rings_at_its_frequency(law, rates) -> None:
    def simulated(speed, x, seconds, step=1e-4):
        forces = []
        for t in np.arange(0.0, seconds, step):
            memory = {"stretch": np.array(x[0]), "speed": np.array(x[1])}
            forces.append(float(law(AdditionalMode(), MODE, memory, speed=np.array(speed(t)))))
            x = x + step * rates(AdditionalMode(), MODE, memory, speed=np.array(speed(t)))
        return np.array(forces)

    accelerated = simulated(lambda t: 2.0 * t, np.zeros(2), 3.0, 1e-3)
    assert accelerated[-1] == pytest.approx(-0.5 * 2.0, rel=0.01)
    ringing = simulated(lambda t: 0.0, np.array([0.01, 0.0]), 0.5)
    crossings = np.flatnonzero(np.diff(np.sign(ringing))) * 1e-4
    assert np.pi / np.diff(crossings).mean() == pytest.approx(30.0 * np.sqrt(1 - 0.1**2), rel=0.01)


def test_leak_is_proportional_and_loses(law) -> None:
    level = np.linspace(0.0, 4.0, 9)
    np.testing.assert_allclose(law(LinearLeak(), {"c": 0.5}, level=level), -0.5 * level)


def test_threshold_flow_begins_at_its_threshold(law) -> None:
    at_once = {"c": 2.0, "threshold": 1.5, "width": 0.0}
    flow = law(ThresholdFlow(), at_once, level=np.array([0.0, 1.5, 2.0, 2.5]))
    np.testing.assert_allclose(flow, [0.0, 0.0, -1.0, -2.0], atol=1e-11)


def test_threshold_flow_may_set_in_over_a_width(law) -> None:
    """c w ln(1 + exp(z / w)): half the slope at the threshold, and the same flow as without a width far above it."""
    soft, level = {"c": 2.0, "threshold": 1.5, "width": 0.1}, np.linspace(0.5, 3.5, 301)
    flow = law(ThresholdFlow(), soft, level=level)
    np.testing.assert_allclose(flow, -2.0 * 0.1 * np.log1p(np.exp((level - 1.5) / 0.1)), rtol=1e-10)
    slope = np.gradient(flow, level)
    assert slope[100] == pytest.approx(-1.0, rel=1e-3) and slope[-1] == pytest.approx(-2.0, rel=1e-6)
    assert flow[0] == pytest.approx(0.0, abs=1e-4)


@pytest.mark.parametrize(("width", "told"), [(0.0, False), (0.2, False), (0.24, False), (0.26, True)])
def test_a_flow_that_bends_over_most_of_what_is_above_its_threshold_has_none(around, width, told) -> None:
    """Seen: what evaporates from a dye bath, told as a threshold at 74.5 degC (0.97) with a width of 5.1 in a bath of 96 degC at most."""
    flow, values = ThresholdFlow(), {"c": 2.0, "threshold": around.ranges["level"].high - 1.5, "width": width}
    assert ("flow set in over most" in (flow.misplaced(around, values) or "")) is told
    assert flow.misplaced(around, {"c": 2.0, "threshold": values["threshold"]}) is None, "without a width"


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_damped_end_stop_takes_energy_and_never_pulls(law, side) -> None:
    speed = 5.0 * np.cos(3.0 * ANGLES)
    values = {"k": 10.0, "c": 4.0, "where": 0.2 * side, "side": side}
    force = law(EndStop(), values, position=ANGLES, speed=speed)
    bare = law(EndStop(), {**values, "c": 0.0}, position=ANGLES, speed=speed)
    assert (side * force <= 0).all() and (force[side * ANGLES <= 0.2] == 0).all()
    assert ((force - bare) * speed <= 1e-12).all()
    assert np.abs(force - bare).max() > 1.0


def test_a_leak_to_a_room_vanishes_at_its_level(law) -> None:
    level = np.array([1.0, 2.0, 3.0])
    np.testing.assert_allclose(law(LinearLeak(), {"c": 0.5, "reference": 2.0}, level=level), [0.5, 0.0, -0.5])
    np.testing.assert_allclose(law(LinearLeak(), {"c": 0.5}, level=level), -0.5 * level)


def test_the_reference_may_lie_at_zero_or_about_the_travelled_levels() -> None:
    """An oven between 80 and 200 degC leaks to a room at 20 degC; levels below zero have a reference too."""
    for low, high, inside in ((80.0, 200.0, (0.0, 20.0, 80.0, 200.0)), (-30.0, -10.0, (-30.0, -20.0, 0.0))):
        around = Surroundings({"level": Range(low, high, 1.0)}, {"level": "degC"}, "degC/s", 1.0)
        reference = next(p for p in LinearLeak().parameters(around) if p.name == "reference")
        assert all(reference.bounds[0] <= place <= reference.bounds[1] for place in inside)
        looked_at = [probe.values["reference"] for probe in LinearLeak().probes(around)]
        assert looked_at == [0.0, low, 0.5 * (low + high)]


@pytest.mark.parametrize(("where", "said"), [(1.4, False), (0.9, True)])
def test_a_stop_may_stand_farther_in_a_travel_that_no_sensor_shows(where, said, around) -> None:
    """Seen: a valve's seat, 0.4 of the travel that the model without it has; told as a stop of the coil that drives it (0.85)."""
    unseen = replace(around, unmeasured=frozenset({"position"}))
    values = {"k": 500.0, "where": where, "c": 1.0, "side": 1.0}
    assert ("no stop gives way" in (EndStop().misplaced(unseen, values) or "")) is said
    assert "no stop gives way" in (EndStop().misplaced(around, values) or "")


@pytest.mark.parametrize("law", [TorqueRipple, PositionDependentFriction, TransmissionError])
def test_an_order_may_turn_out_an_octave_from_the_one_that_a_screen_found(law) -> None:
    """Seen: the friction of an arm's motor, of order 2, held at 2.03 by the bound of a screen's 2.53."""
    around = Surroundings({"position": Range(-3.0, 5.0, 2.0), "speed": Range(-3.0, 5.0, 2.0)}, {}, "N m", 1e-3)
    (order,) = (p for p in law(2.53).parameters(around) if p.name == "order")
    assert order.bounds == pytest.approx((1.265, 5.06)) and order.value == 2.53


def test_a_mode_of_a_heavy_mass_on_a_soft_spring_is_viscous_friction(law) -> None:
    """Which it therefore contains. Seen: the resistance of a circuit, told as a mode (0.85) for 9 % of the error that it left."""
    assert AdditionalMode.generalises == ("viscous_friction",)
    c, mass, omega = 0.7, 1e6, 1e-3
    values = {"mass": mass, "omega": omega, "zeta": c / (2 * omega * mass)}
    at_rest = {"stretch": np.zeros_like(ANGLES), "speed": np.zeros_like(ANGLES)}
    np.testing.assert_allclose(law(AdditionalMode(), values, at_rest, speed=ANGLES), -c * ANGLES, rtol=1e-9)
