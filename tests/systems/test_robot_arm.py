from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from greybox_torch.data import DataSet, load_dataset
from greybox_torch.estimate.comparison import compare
from greybox_torch.estimate.fit import Estimation, fit_records
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.termination import Termination
from greybox_torch.model import Body, Coupling, Signals
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.systems import RobotArm, load_model

RECORDINGS = Path(__file__).parents[3] / "shared" / "recordings" / "robot_arm"
recorded = pytest.mark.skipif(
    not RECORDINGS.is_dir(), reason="the recordings of the real arm (../shared/recordings/robot_arm) are not here"
)


def test_declarations() -> None:
    arm = load_model("robot_arm")
    assert isinstance(arm, RobotArm)
    assert [s.name for s in arm.states] == ["gear_twist", "arm_twist", "motor_speed", "gearbox_speed", "arm_speed"]
    assert [(s.initial, s.fixed) for s in arm.states] == [(0.0, True)] * 2 + [("measured", False)] * 3
    assert [(i.name, i.unit) for i in arm.inputs] == [("torque", "N m")]
    assert [(o.name, o.unit) for o in arm.outputs] == [("motor_speed", "rad/s")]
    names = [p.name for p in arm.declared_parameters]
    assert names == ["F_v", "F_c", "F_cs", "alpha", "beta", "J", "a_m", "a_g", "k_g1", "k_g3", "d_g", "k_a", "d_a"]
    kinds = {port.name: type(port) for port in arm.ports}
    assert kinds == dict.fromkeys(["motor", "gearbox", "arm"], Body) | dict.fromkeys(
        ["gear_spring", "arm_spring"], Coupling
    )
    assert [port.name for port in arm.all_ports[-2:]] == ["actuator", "sensor"]
    assert all(p.description and (p.unit or p.name in ("a_m", "a_g")) for p in arm.declared_parameters)


def test_published_start_values() -> None:
    values = RobotArm().values()
    assert values["a_m"] == pytest.approx(0.17910964111956)
    assert values["k_g3"] == 0.0
    assert values["J"] == pytest.approx(0.03291699877416)


def test_momentum_is_kept() -> None:
    """Inner torques cancel: the torque that is left after friction accelerates the sum of the masses."""
    arm, x = RobotArm(), torch.tensor([0.1, -0.2, 3.0, 2.0, -1.0], dtype=torch.float64)
    p = Signals("parameter", {name: torch.tensor(value, dtype=torch.float64) for name, value in arm.values().items()})
    rates = arm.rates(x, torch.tensor([1.5], dtype=torch.float64), p)
    gained = p.J * (p.a_m * rates[2] + p.a_g * rates[3] + (1 - p.a_m - p.a_g) * rates[4])
    friction = p.F_v * 3.0 + (p.F_c + p.F_cs / torch.cosh(p.alpha * 3.0)) * torch.tanh(p.beta * 3.0)
    assert float(gained) == pytest.approx(float(1.5 - friction))


@pytest.mark.parametrize("port", ["motor", "gearbox", "arm", "gear_spring", "arm_spring"])
def test_ports_act_where_they_say(port: str) -> None:
    """A force on a body speeds that body up; one in a spring pulls its two ends together."""
    arm = RobotArm()
    x = Signals("state", {s.name: torch.zeros((), dtype=torch.float64) for s in arm.states})
    u, p = Signals("input", {"torque": torch.zeros(())}), arm.physical()
    forces = {name.name: float(name.name == port) for name in arm.ports}
    rates = {k: float(v.detach()) for k, v in arm.derivative(x, u, p, Signals("port", forces)).items()}
    signs = {name: np.sign(rates[f"{name}_speed"]) for name in ("motor", "gearbox", "arm")}
    expected = {
        "motor": (1, 0, 0),
        "gearbox": (0, 1, 0),
        "arm": (0, 0, 1),
        "gear_spring": (-1, 1, 0),
        "arm_spring": (0, -1, 1),
    }
    assert tuple(signs.values()) == expected[port]


@given(st.floats(0.01, 0.99), st.floats(0.01, 0.99))
def test_the_arm_keeps_a_share_of_the_inertia(a_m: float, a_g: float) -> None:
    arm = RobotArm()
    arm.set_values({"a_m": a_m, "a_g": a_g})
    assert all(q > 0 for q in arm.admissible(arm.physical()).values()) == (a_m + a_g < 1 - 1e-4)


@cache
def _recordings() -> DataSet:
    return load_dataset(RECORDINGS / "dataset.toml")


@cache
def _published_fit() -> Estimation:
    data = _recordings()
    return fit_records(make_problem(data, RobotArm(), data.estimation()))


@recorded
def test_published_start_values_simulate_as_published() -> None:
    data, arm = _recordings(), RobotArm()
    scores = compare(make_problem(data, arm, data.recordings), data.recordings, Simulator.of(arm, ())).scores
    assert scores[0].fit == pytest.approx(78.7, abs=0.4)
    assert scores[1].fit == pytest.approx(79.4, abs=0.5)


@recorded
def test_fit_of_the_published_problem() -> None:
    """Seven parameters and three initial speeds: the independent optimum of the recordings' README."""
    found = _published_fit()
    assert found.termination in (Termination.converged, Termination.small_step)
    assert found.mse <= 9.47
    optimum = {
        "a_m": 0.26631,
        "a_g": 0.65080,
        "k_g1": 19.985,
        "k_g3": 24.265,
        "d_g": 0.030811,
        "k_a": 11.407,
        "d_a": 0.0025888,
    }
    values = dict(zip(found.problem.names, found.problem.values, strict=True))
    assert list(found.problem.free_names) == list(optimum)
    assert {n: values[n] for n in optimum} == pytest.approx(optimum, rel=0.005)
    assert found.problem.initial[0, 2:] == pytest.approx([-19.000, -22.257, -23.295], abs=0.05)
    data = _recordings()
    simulator = Simulator.of(RobotArm(), found.problem.free_names)
    (own,) = compare(found.problem, data.estimation(), simulator, estimate_starts=False).scores
    assert own.fit >= 85.2
    other = make_problem(data, RobotArm(), data.validation()).with_values(found.problem.values)
    (validation,) = compare(other, data.validation(), simulator).scores
    assert validation.fit >= 84.9


@recorded
def test_standard_deviations_of_the_published_problem() -> None:
    """σ² (JᵀJ)⁻¹ with the initial speeds counted, as an independent program gives it."""
    expected = {
        "a_m": 0.00089,
        "a_g": 0.0022,
        "k_g1": 0.093,
        "k_g3": 1.0,
        "d_g": 0.00084,
        "k_a": 0.26,
        "d_a": 0.00027,
    }
    plain, sandwich = (_published_fit().parameter_deviations(kind) for kind in ("plain", "sandwich"))
    assert plain == pytest.approx(expected, rel=0.05)
    assert all(sandwich[name] > 2 * plain[name] for name in plain)  # the residual is far from white
