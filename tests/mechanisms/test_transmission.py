"""Laws of couplings. A coupling's force is a restoring one: positive where the deflection is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from greybox_torch.mechanisms.mechanism import Range
from greybox_torch.mechanisms.presliding import PreslidingHysteresis
from greybox_torch.mechanisms.stiffness import NonlinearStiffness
from greybox_torch.mechanisms.transmission import (
    HIDDEN_GAP,
    Backlash,
    HystereticSpring,
    NonlinearDamping,
)
from greybox_torch.mechanisms.transmission_error import TransmissionError

from .conftest import named

TWIST = np.linspace(-0.06, 0.06, 241)
RATES = np.linspace(-2.0, 2.0, 81)


def test_dead_zone_is_zero_inside_and_has_slope_one_outside(law) -> None:
    seen = law(Backlash(), {"half_gap": 0.02}, deflection=TWIST)
    assert (np.abs(seen[np.abs(TWIST) < 0.02]) < 1e-15).all()
    np.testing.assert_allclose(seen, -seen[::-1], atol=1e-15)
    outside = TWIST > 0.021
    np.testing.assert_allclose(np.diff(seen[outside]) / np.diff(TWIST[outside]), 1.0)
    assert seen[-1] == pytest.approx(0.04)


@pytest.mark.parametrize(("unmeasured", "times"), [((), 1.0), (("deflection",), HIDDEN_GAP), (("rate",), 1.0)])
def test_a_gap_is_no_wider_than_what_was_deflected_unless_nobody_measured_that(around, unmeasured, times) -> None:
    """Seen: the gap of a press's gears, 14 mrad, told as a spring that stiffens: the model without it plays within 2 mrad, and damps."""
    place = replace(around, unmeasured=frozenset(unmeasured))
    for law in (Backlash(), Backlash(as_force=True)):
        (gap,) = (p for p in law.parameters(place) if p.name == "half_gap")
        assert gap.upper == pytest.approx(times * around.ranges["deflection"].reach)


def test_stiffening(law) -> None:
    force = law(NonlinearStiffness(), {"k_2": 100.0, "k_3": 2000.0}, deflection=TWIST)
    np.testing.assert_allclose(force, -force[::-1], atol=1e-15)
    assert (force * TWIST >= 0).all()
    assert force[-1] == pytest.approx(100 * 0.06**2 + 2000 * 0.06**3)
    assert (np.diff(force)[121:] > np.diff(force)[120]).all()


def test_stiffer_in_one_direction(law) -> None:
    force = law(NonlinearStiffness(), {"k_3": 2000.0, "k_a": 50.0}, deflection=TWIST)
    np.testing.assert_allclose(force, 2000.0 * TWIST**3 + 50.0 * TWIST**2, atol=1e-14)
    assert force[-1] > -force[0]


def test_softening_is_stiff_at_first_and_levels_off(law) -> None:
    force = law(NonlinearStiffness(), {"F_0": 3.0, "d_0": 0.005}, deflection=TWIST)
    np.testing.assert_allclose(force, -force[::-1], atol=1e-15)
    assert (force * TWIST >= 0).all() and (np.diff(force) >= 0).all()
    assert force[-1] == pytest.approx(3.0, rel=1e-6)
    slope = np.diff(force) / np.diff(TWIST)
    assert slope.max() == pytest.approx(3.0 / 0.005, rel=0.01) and (np.diff(slope)[121:] <= 0).all()


def test_nonlinear_damping_opposes_the_rate(law) -> None:
    force = law(NonlinearDamping(), {"d_2": 0.5, "d_0": 0.2, "r_0": 0.01}, rate=RATES)
    np.testing.assert_allclose(force, -force[::-1], atol=1e-15)
    assert (force * RATES >= 0).all()
    assert force[-1] == pytest.approx(0.5 * 4 + 0.2)


def test_transmission_error_is_periodic_in_position_and_leaves_the_rest(law) -> None:
    mechanism, values = TransmissionError(4.5), {"a": 0.003, "b": 0.004}
    position = np.linspace(0.0, 3.0, 241)
    here, on = (
        law(mechanism, values, deflection=TWIST, position=position + shift) - TWIST for shift in (0.0, 2 * np.pi / 4.5)
    )
    np.testing.assert_allclose(here, on, atol=1e-15)
    assert np.abs(here).max() == pytest.approx(0.005, rel=0.01)


def test_harmonics_of_a_transmission_error(law) -> None:
    """Seen: the wheel of a drum off its centre and oval; what the first order left was told as an input that changes along the way."""
    (form, start), position = (
        TransmissionError(4.5).richer({"a": 0.003, "b": 0.004, "order": 4.4})[0],
        np.linspace(0.0, 3.0, 241),
    )
    assert start == {"a": 0.003, "b": 0.004, "order": 4.4} and not form.richer(start)
    given = {"a": 0.003, "a_2": 0.001, "b_3": 0.002, "order": 4.4}
    error = law(form, given, deflection=TWIST, position=position) - TWIST
    angle = 4.4 * position
    np.testing.assert_allclose(
        error, 0.003 * np.cos(angle) + 0.001 * np.cos(2 * angle) + 0.002 * np.sin(3 * angle), atol=1e-15
    )


def test_a_transmission_error_written_as_a_force_is_what_the_spring_makes_of_it(law, around) -> None:
    """To first order k e(θ), for a model in which no state reaches the spring alone."""
    form = TransmissionError(4.5, harmonics=3).written_as_force()
    assert not form.kinematic and TransmissionError(4.5).kinematic
    assert [p.name for p in form.parameters(around)] == ["a", "b", "a_2", "b_2", "a_3", "b_3", "order"]
    assert {p.unit for p in form.parameters(around) if p.name != "order"} == {around.force_unit}
    assert [probe.values for probe in form.probes(around)] == [{"order": 4.5}]
    position = np.linspace(0.0, 3.0, 241)
    given = {"a": 0.3, "b": 0.4, "order": 4.4}
    force = law(TransmissionError(4.5, as_force=True), given, deflection=TWIST, position=position)
    np.testing.assert_allclose(force, 0.3 * np.cos(4.4 * position) + 0.4 * np.sin(4.4 * position), atol=1e-15)
    assert TransmissionError(4.5, as_force=True).richer(given)[0][0].options() == {**form.options(), "order": 4.4}
    plainer = form.plainer({**given, "a_2": 0.0, "b_2": 0.0, "a_3": 0.0, "b_3": 0.0})
    assert plainer is not None and plainer[0].options() == {"order": 4.4, "harmonics": 1, "as_force": True}


SLIP = {"F": 1.5, "z_0": 0.01}


@given(rate=st.floats(-50.0, 50.0), z=st.floats(-1.0, 1.0))
def test_slip_only_stores_and_dissipates(law, rates, rate, z) -> None:
    memory = {"slip": np.array(0.01 * z)}
    force = law(HystereticSpring(), SLIP, memory, rate=np.array(rate))
    change = rates(HystereticSpring(), SLIP, memory, rate=np.array(rate))[0]
    stored = 1.5 / 0.01 * memory["slip"] * change  # d/dt of F z² / (2 z_0)
    assert force * rate - stored >= -1e-12


def test_hysteretic_spring_dissipates_over_a_closed_cycle_and_saturates(law, rates) -> None:
    step, slip, work, forces = 5e-4, 0.0, 0.0, []
    for t in np.arange(0.0, 3.0, step):
        rate, memory = np.array(0.4 * np.cos(2 * np.pi * t)), {"slip": np.array(slip)}
        forces.append(float(law(HystereticSpring(), SLIP, memory, rate=rate)))
        work += forces[-1] * float(rate) * step * (t >= 2.0)
        slip += step * float(rates(HystereticSpring(), SLIP, memory, rate=rate)[0])
    travel = 4 * 0.4 / (2 * np.pi)
    assert 0.5 * 1.5 * travel < work < 1.5 * travel
    assert 1.4 < max(forces) < 1.5


def test_a_damper_that_differs_by_direction(law) -> None:
    """Beside a damper d of the model, d + d_a acts in one direction and d − d_a in the other."""
    rate = np.linspace(-2.0, 2.5, 10)
    force = 5.0 * rate + law(NonlinearDamping(), {"d_a": 2.0}, rate=rate)
    np.testing.assert_allclose(force, np.where(rate > 0, 7.0, 3.0) * rate, rtol=1e-14)


def test_the_screen_looks_for_the_difference_alone(around) -> None:
    assert ("d_a",) in [probe.directions for probe in NonlinearDamping().probes(around)]


def test_how_soon_it_may_slip_is_told_by_the_usual_rate(around) -> None:
    """Seen: an arm's joint that slips at 0.0085 rad; the plain model, which damps less, peaked at 90 rad/s, so that 0.045 was the least."""
    peaked = Range(-9 * around.ranges["rate"].rms, 1.0, around.ranges["rate"].rms)
    places = (around, replace(around, ranges={**around.ranges, "rate": peaked}))
    least = [p.lower for place in places for p in HystereticSpring().parameters(place) if p.name == "z_0"]
    assert least == [pytest.approx(0.5 * around.ranges["rate"].rms * around.sample_time)] * 2


@pytest.mark.parametrize(
    ("mechanism", "speed", "memory"),
    [(HystereticSpring(), "rate", "slip"), (PreslidingHysteresis(), "speed", "bristle")],
)
def test_what_slips_stays_finite_where_a_step_is_too_long_for_it(rates, mechanism, speed, memory) -> None:
    """Seen: start states before a dead time had passed, so fast that no refit with a hysteretic spring could be simulated."""
    z_0, step = 0.01, 0.002
    values = {"z_0": z_0, **({"sharpness": 0.5} if memory == "slip" else {})}

    def stepped(slip: float, fast: float) -> float:
        def of(z: float) -> float:
            return float(rates(mechanism, values, {memory: np.array(z)}, **{speed: np.array(fast)})[0])

        k1 = of(slip)
        k2 = of(slip + 0.5 * step * k1)
        k3 = of(slip + 0.5 * step * k2)
        return slip + step / 6 * (k1 + 2 * (k2 + k3) + of(slip + step * k3))

    slip = 0.0
    for _ in range(20):
        slip = stepped(slip, 200.0)  # forty times what the steps resolve
        assert abs(slip) < 200 * z_0
    for _ in range(200):
        slip = stepped(slip, 1.0)
    assert slip == pytest.approx(z_0, rel=1e-6)


@pytest.mark.parametrize("as_force", [False, True])
def test_the_gap_has_a_middle_of_its_own_where_sensors_show_the_deflection(law, around, as_force) -> None:
    """Seen: a dog clutch whose play lay 1.6 mrad off the zeros of its encoders, told as a spring that stiffens beside an offset (0.97)."""
    names = {p.name for p in Backlash(as_force).parameters(around)}
    hidden = {p.name for p in Backlash(as_force).parameters(replace(around, unmeasured=frozenset({"deflection"})))}
    assert names - hidden == {"centre"}
    values = {"half_gap": 0.02, "centre": 0.005, **({"stiffness": 1.0} if as_force else {})}
    signals = {"deflection": TWIST, "rate": 0.0 * TWIST}
    transmitted = law(Backlash(as_force), values, **signals) + (TWIST if as_force else 0.0)
    expected = np.sign(TWIST - 0.005) * np.maximum(np.abs(TWIST - 0.005) - 0.02, 0.0)
    np.testing.assert_allclose(transmitted, expected, atol=1e-14)


def test_the_valves_of_a_damper_differ_by_direction(law, around) -> None:
    plain = {"d_a": 2.0, "d_2": 0.5, "d_0": 3.0, "r_0": 1e-3}
    rate = np.array([-2.0, 0.0, 2.0])  # far beyond where either level is reached
    np.testing.assert_allclose(law(NonlinearDamping(), plain, rate=rate), [-1.0, 0.0, 9.0], atol=1e-12)
    ((richer, begun),) = NonlinearDamping().richer(plain)
    assert [p.name for p in richer.parameters(around)] == ["d_a", "d_2", "d_0", "d_b", "r_0"] and not richer.richer(
        begun
    )
    np.testing.assert_allclose(law(richer, begun, rate=rate), [-1.0, 0.0, 9.0], atol=1e-12)
    np.testing.assert_allclose(law(richer, {**begun, "d_b": 1.0}, rate=rate), [0.0, 0.0, 10.0], atol=1e-12)


def test_a_spring_runs_into_rubber_on_either_side(law) -> None:
    values = {"from_up": 0.02, "a_up": 100.0, "b_up": 5e3, "from_down": 0.04, "a_down": 50.0, "b_down": 0.0}
    force = law(NonlinearStiffness(stops=True), values, deflection=np.array([-0.05, -0.04, 0.0, 0.02, 0.03]))
    np.testing.assert_allclose(force, [-0.5, 0.0, 0.0, 0.0, 1.5], atol=1e-12)


@pytest.mark.parametrize("as_force", [False, True])
def test_what_touches_beyond_a_gap_may_grow_stiffer(law, around, as_force) -> None:
    """Seen: a tendon's slack, told as a spring that runs into rubber (0.96), as that has a stiffness that grows."""
    (form, start), values = Backlash(as_force).richer({"half_gap": 0.02})[0], {"half_gap": 0.02, "k_2": 50.0}
    assert start == {"half_gap": 0.02, "k_2": 0.0} and not form.richer(start)
    assert "k_2" in {p.name for p in form.parameters(around)} - {p.name for p in Backlash(as_force).parameters(around)}
    plainer = form.plainer(values)
    assert plainer is not None and plainer[0].options() == Backlash(as_force).options() and "k_2" not in plainer[1]
    pressed = np.sign(TWIST) * np.maximum(np.abs(TWIST) - 0.02, 0.0)
    if as_force:
        force = law(form, values | {"stiffness": 3.0}, deflection=TWIST, rate=0.0 * TWIST)
        np.testing.assert_allclose(3.0 * TWIST + force, 3.0 * pressed + 50.0 * pressed * np.abs(pressed), atol=1e-14)
    else:
        seen, zero = law(form, values, deflection=TWIST, rate=0.0 * TWIST).copy(), np.zeros_like(TWIST)
        np.testing.assert_allclose(seen, pressed, atol=1e-14)
        s, p = named("signal", {"deflection": seen, "rate": zero}), named("parameter", {**values, "damping": 0.0})
        np.testing.assert_allclose(form.force_beside(s, p), 50.0 * pressed * np.abs(pressed), atol=1e-14)
    assert form.written_as_force().options() == {"as_force": True, "stiffening": True}
