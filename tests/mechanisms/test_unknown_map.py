"""A flexible map over an input and a speed."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from greybox_torch.diagnosis.describe.memory import settled_curve
from greybox_torch.diagnosis.screen.candidates import memory_candidates
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.matching import law_force
from greybox_torch.mechanisms.surroundings import Range, Surroundings
from greybox_torch.mechanisms.unknown_map import KNOTS, UnknownMap
from greybox_torch.systems import RobotArm
from tests.mechanisms.adding_tank import fitted, ports_asked

AROUND = Surroundings(
    {"input": Range(0.0, 1.0, 0.6), "speed": Range(-100.0, 300.0, 150.0)},
    {"input": "V", "speed": "rad/s"},
    "N m",
    1e-3,
)


def mapped(values: dict[str, float], u: np.ndarray, v: np.ndarray) -> np.ndarray:
    signals = {"input": torch.as_tensor(u), "speed": torch.as_tensor(v)}
    return np.asarray(law_force(UnknownMap(), AROUND, signals, values))


def values_of(heights: np.ndarray) -> dict[str, float]:
    values = {p.name: p.value for p in UnknownMap().parameters(AROUND)}
    return values | {f"w_{i}_{j}": float(heights[i, j]) for i in range(KNOTS) for j in range(KNOTS)}


def test_it_is_the_sum_of_products_of_bumps() -> None:
    rng = np.random.default_rng(0)
    heights = rng.normal(size=(KNOTS, KNOTS))
    u, v = rng.uniform(0, 1, 50), rng.uniform(-100, 300, 50)
    over = [np.exp(-((4 * s + 1 - np.arange(KNOTS)[:, None]) ** 2)) for s in (u, (v + 100) / 400)]
    np.testing.assert_allclose(mapped(values_of(heights), u, v), np.einsum("ij,in,jn->n", heights, *over), atol=1e-12)


def test_a_smooth_map_that_is_no_product_is_within_two_per_cent() -> None:
    """The torque of a diesel over fuel and speed, whose best speed moves with the fuel."""
    u, v = (m.ravel() for m in np.meshgrid(np.linspace(0, 1, 40), np.linspace(-100, 300, 40)))
    torque = 300 * u * (1 - 0.75 * ((v - 50 - 125 * u) / 215) ** 2)
    columns = np.stack([mapped(values_of(unit), u, v) for unit in np.eye(KNOTS**2).reshape(-1, KNOTS, KNOTS)], axis=1)
    left = torque - columns @ np.linalg.lstsq(columns, torque, rcond=1e-8)[0]
    assert np.sqrt(np.mean(left**2)) < 0.02 * np.std(torque)


def test_beyond_where_the_signals_moved_it_stays_level() -> None:
    values = values_of(np.random.default_rng(1).normal(size=(KNOTS, KNOTS)))
    inside = mapped(values, np.array([0.0, 1.0]), np.array([-100.0, 300.0]))
    np.testing.assert_allclose(mapped(values, np.array([-3.0, 9.0]), np.array([-500.0, 900.0])), inside)


def test_it_is_asked_for_at_actuators_that_drive_a_body() -> None:
    arm = RobotArm()
    around = {q.name: AROUND for q in arm.all_ports}
    assert [a.port for a in memory_candidates(arm, around) if isinstance(a.mechanism, UnknownMap)] == ["actuator"]
    assert not ports_asked(UnknownMap), "the tank has no speed"


def test_its_curve_is_a_cut_through_the_middle() -> None:
    values = values_of(np.random.default_rng(2).normal(size=(KNOTS, KNOTS)))
    curve = settled_curve(attach(RobotArm(), "actuator", UnknownMap()), AROUND, fitted("unknown_map", values))
    assert curve is not None and (curve.signal, curve.unit, curve.force_unit) == ("input", "V", "N m")
    np.testing.assert_allclose(curve.force, mapped(values, curve.values, np.full(len(curve.values), 100.0)))
    assert curve.values[[0, -1]] == pytest.approx([0.0, 1.0])
