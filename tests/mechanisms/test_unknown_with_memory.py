"""The residual with memory is the filter that it says it is."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.mechanisms.unknown_with_memory import UnknownWithMemory

ONE = {"direct": 0.3, "remembered": -2.0, "T": 0.05}
TWO = {"direct": 0.3, "remembered": -2.0, "swing": 0.7, "omega": 40.0, "zeta": 0.25}
SLOW = {**TWO, "zeta": 3.0}


@pytest.mark.parametrize(("modes", "values"), [(1, ONE), (2, TWO), (2, SLOW)])
def test_response_and_memory_are_those_of_its_equations(law, rates, modes: int, values: dict[str, float]) -> None:
    """By the matrices of the state equations, dz/dt = A z + B s, force = C z + D s, that rates and force are asked for one by one."""
    mechanism, names = UnknownWithMemory("speed", modes), ["z", "r"][:modes]
    units = [{n: float(n == one) for n in names} for one in names]
    nothing = dict.fromkeys(names, 0.0)
    a = np.stack([rates(mechanism, values, u, speed=0.0).ravel() for u in units], axis=1)
    b = rates(mechanism, values, nothing, speed=1.0).ravel()
    c = np.array([float(law(mechanism, values, u, speed=0.0)) for u in units])
    d = float(law(mechanism, values, nothing, speed=1.0))
    omega = np.array([0.0, 3.0, 40.0, 900.0])
    wanted = [c @ np.linalg.solve(1j * w * np.eye(modes) - a, b) + d for w in omega]
    np.testing.assert_allclose(mechanism.response(values, omega), wanted, rtol=1e-9)
    assert mechanism.seconds(values) == pytest.approx(-1.0 / np.linalg.eigvals(a).real.max())


def test_it_begins_settled(law, rates, anywhere) -> None:
    speed = anywhere["speed"]
    for modes, values in ((1, ONE), (2, TWO)):
        mechanism = UnknownWithMemory("speed", modes)
        memory = {"z": np.asarray(speed), "r": np.zeros_like(speed)}
        memory = {s: memory[s] for s in ["z", "r"][:modes]}
        assert np.abs(rates(mechanism, values, memory, speed=speed)).max() == 0.0
        settled = float(mechanism.response(values, np.zeros(1))[0].real)
        np.testing.assert_allclose(law(mechanism, values, memory, speed=speed), settled * speed)


def test_with_a_curve_in_front_it_follows_that(law, rates, around, anywhere) -> None:
    mechanism, curve = UnknownWithMemory("speed", knots=6), Unknown("speed", 6)
    heights = {f"w_{k}": 0.1 * k - 0.2 for k in range(6)}
    speed, z = anywhere["speed"], 0.01 * anywhere["position"]
    found = rates(mechanism, {**heights, "T": 0.2}, {"z": z}, speed=speed)
    np.testing.assert_allclose(found[0], (law(curve, heights, speed=speed) - z) / 0.2)
    np.testing.assert_allclose(law(mechanism, {**heights, "T": 0.2}, {"z": z}, speed=speed), z)
    assert [s.unit for s in mechanism.states(around)] == ["N m"]


def test_a_memory_of_less_than_some_samples_or_more_than_the_record_says_nothing(around) -> None:
    """Samples of 1 ms, a record of 10 s."""
    one, two = UnknownWithMemory("speed"), UnknownWithMemory("speed", 2)
    sound = {"direct": 0.0, "remembered": 1.0}
    assert one.degenerate(around, {**sound, "T": 0.05}, {"remembered": 0.1}) is None
    assert "shorter than" in (one.degenerate(around, {**sound, "T": 0.0025}, {}) or "")
    assert "longer than" in (one.degenerate(around, {**sound, "T": 25.0}, {}) or "")
    assert "deviation" in (one.degenerate(around, {**sound, "T": 0.05}, {"remembered": 2.0}) or "")
    assert "swings" in (two.degenerate(around, {**sound, "swing": 0.0, "omega": 0.5, "zeta": 0.3}, {}) or "")


def test_it_is_looked_for_from_a_few_samples_to_a_third_of_the_record(around) -> None:
    times = [probe.values["T"] for probe in UnknownWithMemory("speed").probes(around)]
    assert (times[0], times[-1]) == pytest.approx((4e-3, 10.0 / 3))
    assert np.all(np.diff(np.log(times)) < np.log(3.0)), "no time constant lies between two looks unseen"
