"""Where the signals around every port moved."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.surroundings import _is_measured, surroundings_along, survey
from greybox_torch.model.ports import driving_body
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import whole_records
from greybox_torch.systems import RobotArm
from greybox_torch.systems.load import load_model


class TwoMasses(gt.GreyBoxModel):
    """Two positions that sensors show, and two speeds."""

    states = [gt.State(f"{kind}_{n}", unit) for n in (1, 2) for kind, unit in (("q", "m"), ("w", "m/s"))]
    inputs = [gt.Input("force", "N")]
    outputs = [gt.Output("first", "m"), gt.Output("second", "m")]
    parameters = [gt.Parameter("m", 1.0, "kg")]
    ports = []

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"q_1": x.w_1, "q_2": x.w_2, "w_1": u.force / p.m, "w_2": -u.force / p.m}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"first": x.q_1, "second": x.q_2}


@pytest.fixture(scope="module")
def states(arm_search) -> np.ndarray:
    """Along windows of the middle length, each from its own start."""
    plain, over = arm_search.plain, arm_search.plain.fits[1]
    run = plain.simulator.run(
        over.problem.records, Pass(over.windows, over.problem.values, over.starts, keep_states=True)
    )
    sizes = np.diff(over.windows.start, append=plain.problem.records.u.shape[1])
    return np.concatenate([run.states[w, :n] for w, n in enumerate(sizes)])


@pytest.mark.parametrize(
    ("port", "signal", "column"),
    [
        ("motor", "speed", 2),
        ("gearbox", "speed", 3),
        ("arm", "speed", 4),
        ("gear_spring", "deflection", 0),
        ("arm_spring", "deflection", 1),
    ],
)
def test_ranges_of_states(arm_search, states, port, signal, column) -> None:
    found = arm_search.surroundings[port].ranges[signal]
    assert (found.low, found.high) == (states[:, column].min(), states[:, column].max())
    assert found.rms == pytest.approx(np.sqrt(np.mean(states[:, column] ** 2)))
    assert found.reach == max(-found.low, found.high)


def test_signals_by_port(arm_search) -> None:
    assert {port: set(around.ranges) for port, around in arm_search.surroundings.items()} == {
        **{
            body: {"speed", "position", "load", "time", "input@torque", f"rate@{body}", f"direction@{body}"}
            | ({"along@torque"} if body == "motor" else set())
            for body in ("motor", "gearbox", "arm")
        },
        "gear_spring": {"deflection", "rate", "speed", "position", "load", "time"},
        "arm_spring": {"deflection", "rate", "speed", "position", "time"},
        "actuator": {"input", "speed", "time"},
        "sensor": {"output", "time"},
    }


def test_what_no_sensor_shows_is_known_only_as_a_model_without_effects_moves_it(arm_search) -> None:
    found = {port: around.unmeasured for port, around in arm_search.surroundings.items()}
    springs = {"gear_spring": {"deflection", "rate"}, "arm_spring": {"deflection", "rate"}}
    bodies = {body: {"position"} for body in ("motor", "gearbox", "arm")}
    assert found == dict.fromkeys(found, frozenset()) | springs | bodies, "the speed of the motor alone is measured"


def test_a_difference_of_measured_states_is_measured() -> None:
    model = TwoMasses()
    assert _is_measured(model, lambda x, u, p: x.q_1 - x.q_2) and _is_measured(model, "q_1")
    assert not _is_measured(model, lambda x, u, p: x.w_1 - x.w_2) and not _is_measured(model, "w_2")


def test_functions_integrals_and_recorded_signals(arm_search, states) -> None:
    around, records = arm_search.surroundings, arm_search.problem.records
    rate = states[:, 2] - states[:, 3]
    assert around["gear_spring"].ranges["rate"].high == pytest.approx(rate.max())
    position = 1e-3 * np.concatenate([[0.0], np.cumsum(states[:-1, 2])])
    for port in ("motor", "gear_spring"):  # a coupling's position is that of the first body
        found = around[port].ranges["position"]
        assert (found.low, found.high) == (pytest.approx(position.min()), pytest.approx(position.max()))
    assert around["actuator"].ranges["input"].low == records.u.min()
    assert around["sensor"].ranges["output"].high == records.y.max()
    assert around["motor"].ranges["time"].high == pytest.approx(1.499)


def test_units(arm_search) -> None:
    around = arm_search.surroundings
    assert {port: a.force_unit for port, a in around.items()} == {
        **dict.fromkeys(("motor", "gearbox", "arm", "gear_spring", "arm_spring", "actuator"), "N m"),
        "sensor": "rad/s",
    }
    assert around["motor"].units == {
        **{"speed": "rad/s", "position": "rad", "time": "s", "rate@motor": "rad/s^2"},
        **dict.fromkeys(("input@torque", "along@torque"), "N m"),
    }
    assert around["gear_spring"].units["rate"] == "rad/s"
    assert around["motor"].per("speed") == "N m/(rad/s)" and around["motor"].per("speed", 2) == "N m/(rad/s)^2"
    assert around["motor"].sample_time == pytest.approx(1e-3)


def test_position_of_the_model_and_missing_samples(data_set, machines: Path) -> None:
    pendulum = load_model(f"{machines / 'pendulum.py'}:Pendulum")
    angle = 0.5 * np.cos(4.0 * np.arange(100) * 0.01)
    angle[3] = np.nan
    units = {"torque": "N m", "position": "rad", "velocity": "rad/s"}
    dataset = data_set(units, [{"torque": 0 * angle, "position": angle, "velocity": 0 * angle}])
    problem = make_problem(dataset, pendulum, dataset.recordings)
    simulator = Simulator.of(pendulum, ())
    around = survey(pendulum, problem, simulator)
    run = simulator.run(
        problem.records, Pass(whole_records(problem.records), problem.values, problem.initial, keep_states=True)
    ).states[0]
    assert around["arm"].ranges["position"].high == pytest.approx(0.5, abs=1e-4), "as measured"
    assert around["arm"].ranges["speed"].high == run[:, 1].max(), "as simulated: a speed is read with more noise"
    assert around["arm"].units["position"] == "rad"
    assert around["sensor.position"].ranges["output"].high == np.nanmax(angle)
    assert set(around) == {"arm", "actuator", "sensor.position", "sensor.velocity"}


def test_driving_body_is_the_first() -> None:
    body = driving_body(RobotArm().ports)
    assert body is not None and body.name == "motor"


class Sledge(gt.GreyBoxModel):
    """A mass on a spring to a moved base: twist and rate are functions, the lever's path has a factor."""

    states = [gt.State("x", "m"), gt.State("v", "m/s")]
    inputs = [gt.Input("base", "m")]
    outputs = [gt.Output("x", "m")]
    parameters = [gt.Parameter("k", 50.0, unit="N/m"), gt.Parameter("r", 2.0, unit="m"), gt.Parameter("m", 1.0, "kg")]
    ports = [
        gt.Coupling("spring", deflection=lambda x, u, p: u.base - x.x, rate=lambda x, u, p: -x.v),
        gt.Coupling("lever", deflection=lambda x, u, p: p.r * x.x, rate=lambda x, u, p: p.r * x.v),
        gt.Coupling("screw", deflection=lambda x, u, p: p.r * u.base - x.x, rate=lambda x, u, p: -x.v),
    ]

    def derivative(self, x, u, p, port):
        return {"x": x.v, "v": (p.k * (u.base - x.x) + port.spring - port.lever + port.screw) / p.m}

    def output(self, x, u, p):
        return {"x": x.x}


def test_a_difference_of_lengths_is_a_length() -> None:
    signals = {"base": np.sin(np.arange(50) * 0.1), "x": np.zeros(50)}
    data = gt.DataSet([gt.Recording.from_arrays("Run", signals, sample_time=0.01, role="estimation")])
    problem = make_problem(data, Sledge(), data.recordings)
    found = surroundings_along(problem.model, problem, np.zeros((50, 2)))
    spring, lever = found["spring"], found["lever"]
    assert (spring.units["deflection"], spring.units["rate"], spring.force_unit) == ("m", "m/s", "N")
    assert "deflection" not in lever.units and lever.force_unit == ""
    assert found["screw"].units["deflection"] == "m", "a lead times an angle less a travel is a travel"


def test_a_measured_position_ranges_as_far_as_the_sensor_shows(data_set) -> None:
    """Seen: a leg whose model lacks the knee's stop: it ran to 0.66 rad, the knee to 0.08, and a stop was looked for beyond that."""

    class Sled(TwoMasses):
        ports = [
            gt.Body("first", position="q_1", speed="w_1"),
            gt.Body("apart", position=lambda x, u, p: x.q_2 - x.q_1, speed="w_2"),
        ]

    time = np.arange(400) * 0.01
    q = np.minimum(np.sin(time), 0.5)
    data = data_set(
        {"force": "N", "first": "m", "second": "m"},
        [{"force": np.ones(400), "first": q, "second": np.zeros(400)}],
        roles=["estimation"],
        sample_time=0.01,
    )
    problem = make_problem(data, Sled(), data.estimation())
    states = np.zeros((400, 4))
    states[:, 0] = np.linspace(-3.0, 3.0, 400)
    found = surroundings_along(Sled(), problem, states)
    first, apart = (found[name].ranges["position"] for name in ("first", "apart"))
    assert (first.low, first.high) == pytest.approx((q.min(), 0.5), abs=0.02)
    assert (apart.low, apart.high) == pytest.approx((-0.5, -q.min()), abs=0.02)
