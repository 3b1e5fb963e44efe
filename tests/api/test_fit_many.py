"""Many machines estimated in one batch come to what each comes to alone."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.data.recording import Role
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.together.free_runs import FreeRuns
from greybox_torch.simulation import SimulationOptions, Simulator
from tests.api.motor import UNITS, Motor
from tests.cuda import needs_cuda

RATE = 0.01
ROLES: tuple[tuple[str, Role], ...] = (("Steps", "estimation"), ("More", "validation"))


class Shaft(gt.GreyBoxModel):
    """Two masses on a spring, both speeds measured, in units of different size: outputs weigh differently from machine to machine."""

    states = [gt.State("motor", "rad/s"), gt.State("twist", "rad", initial=0.0), gt.State("load", "rad/s")]
    inputs = [gt.Input("torque", "N m")]
    outputs = [gt.Output("motor", "rad/s"), gt.Output("turns", "1/min")]
    parameters = [
        gt.Parameter("k", 5.0, unit="N m/rad", lower=0.0),
        gt.Parameter("d", 0.02, unit="N m s/rad", lower=0.0),
        gt.Parameter("b", 0.0, unit="N m s/rad", lower=0.0),
    ]
    ports = [gt.Body("load", speed="load")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        spring = p.k * x.twist + p.d * (x.motor - x.load)
        return {
            "motor": (u.torque - spring) / 0.01,
            "twist": x.motor - x.load,
            "load": (spring - p.b * x.load + port.load) / 0.02,
        }

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"motor": x.motor, "turns": 9.55 * x.load}


def motors(count: int, lengths: tuple[int, ...] = (300,)) -> list[gt.DataSet]:
    """Motors of different inertia and friction, recorded for so many samples in turn, twice each."""
    rng = np.random.default_rng(3)
    found = []
    for m in range(count):
        n, inertia, friction = lengths[m % len(lengths)], 0.02 * rng.uniform(0.7, 1.4), 0.05 * rng.uniform(0.5, 1.5)
        recordings = []
        for name, role in ROLES:
            voltage = np.repeat(rng.uniform(-6, 6, n // 50 + 1), 50)[:n]
            speed, keep = np.zeros(n), np.exp(-friction / inertia * RATE)
            for k in range(n - 1):
                speed[k + 1] = keep * speed[k] + (1 - keep) * 0.1 / friction * voltage[k]
            signals = {"voltage": voltage, "speed": speed + 0.02 * rng.normal(size=n)}
            recordings.append(gt.Recording.from_arrays(name, signals, sample_time=RATE, role=role, units=UNITS))
        found.append(gt.DataSet(recordings, name=f"Motor {m}"))
    return found


def shafts(count: int) -> list[gt.DataSet]:
    rng = np.random.default_rng(4)
    found = []
    for m in range(count):
        n = 200
        torque = np.repeat(rng.uniform(-1, 1, n // 40 + 1), 40)[:n] * (1.0 + m)
        silent = gt.Recording.from_arrays(
            "Steps",
            {"torque": torque, "motor": np.zeros(n), "turns": np.zeros(n)},
            sample_time=RATE,
            role="estimation",
            units={"torque": "N m", "motor": "rad/s", "turns": "1/min"},
        )
        rest = {name: {"value": 0.0, "fixed": True} for name in ("motor", "load")}
        data = gt.DataSet([silent], initial=rest, held_out_by_default=False)
        model = Shaft()
        model.set_values({"k": 6.0 + m, "d": 0.025, "b": 0.01 * (m + 1)})
        run = gt.simulate(model, data)["Steps"]
        signals = {"torque": torque, **{k: v + 0.01 * np.std(v) * rng.normal(size=n) for k, v in run.items()}}
        recording = gt.Recording.from_arrays("Steps", signals, sample_time=RATE, role="estimation")
        found.append(gt.DataSet([recording], name=f"Shaft {m}", held_out_by_default=False))
    return found


def check_same(one: gt.FitResult, other: gt.FitResult) -> None:
    assert one.status == other.status
    assert [p.fixed for p in one.parameters.values()] == [p.fixed for p in other.parameters.values()]
    for name, own in one.parameters.items():
        assert other.parameters[name].value == pytest.approx(own.value, rel=1e-6, abs=1e-9)
        assert other.parameters[name].std == pytest.approx(own.std, rel=1e-4)
    for a, b in zip(one.scores, other.scores, strict=True):
        assert (a["experiment"], a["model"]) == (b["experiment"], b["model"])
        assert b["fit"] == pytest.approx(a["fit"], abs=1e-5)
    assert one.estimation.substeps == other.estimation.substeps
    assert one.estimation.iterations == other.estimation.iterations


def test_every_machine_comes_to_its_own_optimum() -> None:
    data = motors(4, lengths=(200, 500))
    data[2] = gt.DataSet(data[2].recordings, name="Weighed", parameters={"J": {"value": 0.02, "fixed": True}})
    together = gt.fit_many(Motor(), data)
    for found, own in zip(together, data, strict=True):
        assert isinstance(found, gt.FitResult)
        assert found.data is own
        check_same(gt.fit(Motor(), own), found)
    inertias = [found.parameters["J"].value for found in together if isinstance(found, gt.FitResult)]
    assert np.ptp(inertias) > 0.003


def test_outputs_are_weighed_machine_by_machine_and_amplitudes_begin_without() -> None:
    data = shafts(2)
    for found, own in zip(gt.fit_many(Shaft(), data), data, strict=True):
        assert isinstance(found, gt.FitResult)
        check_same(gt.fit(Shaft(), own), found)
        assert found.parameters["b"].value > 0


def test_poor_start_values_are_led_on_alone() -> None:
    data = motors(2)
    data[1] = gt.DataSet(data[1].recordings, name="Poor", parameters={"J": 5.0, "b": 0.9})
    said: list[str] = []
    together = gt.fit_many(Motor(), data, progress=said.append)
    assert said == ["1 machines together, 1 alone"]
    assert isinstance(together[1], gt.FitResult)
    check_same(gt.fit(Motor(), data[1]), together[1])


def test_a_machine_at_fault_stops_nothing_where_that_is_asked_for() -> None:
    data = motors(3)
    only = [gt.Recording.from_arrays("All", data[1].recordings[0].signals, sample_time=RATE, role="validation")]
    data[1] = gt.DataSet(only, name="Nothing to estimate from")
    with pytest.raises(gt.UserError, match="no experiment has the role"):
        gt.fit_many(Motor(), data)
    found = gt.fit_many(Motor(), data, return_exceptions=True)
    assert [type(each).__name__ for each in found] == ["FitResult", "UserError", "FitResult"]


def test_one_data_set_is_no_list() -> None:
    with pytest.raises(gt.UserError, match="a list of data sets"):
        gt.fit_many(Motor(), cast(Any, motors(1)[0]))
    assert gt.fit_many(Motor(), []) == []


@pytest.mark.parametrize(
    "device",
    ["cpu", pytest.param("cuda", marks=needs_cuda)],
)
def test_torch_operations_take_batches_too(device: str, monkeypatch: pytest.MonkeyPatch) -> None:
    model, data = Motor(), motors(3, lengths=(30,))
    problems = tuple(make_problem(each, model, each.estimation()) for each in data)
    points = {m: np.array([0.02 + 0.01 * m, 0.05, 1.0]) for m in range(3)}
    compiled = FreeRuns(problems, Simulator.of(model, problems[0].free_names), (1, 1, 1)).quadratics(points)
    monkeypatch.setattr("greybox_torch.simulation.simulator.native_stepper", lambda *asked: None)
    eager = Simulator.of(model, problems[0].free_names, SimulationOptions(device))
    assert not eager.compiled
    for m, found in FreeRuns(problems, eager, (1, 1, 1)).quadratics(points).items():
        own = compiled[m]
        assert found is not None and own is not None
        np.testing.assert_allclose(found.hessian, own.hessian, rtol=1e-8)
        np.testing.assert_allclose(found.gradient, own.gradient, rtol=1e-8)
