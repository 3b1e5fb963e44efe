"""Estimation on the documentation's motor, whose exact response is known."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greybox_torch.data import DataSet
from greybox_torch.errors import NumericalError, UserError
from greybox_torch.estimate.comparison import compare
from greybox_torch.estimate.fit import Estimation, fit_records
from greybox_torch.estimate.initial import estimate_initial
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.estimate.termination import Termination
from greybox_torch.model import GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.systems import load_model

UNITS = {"voltage": "V", "speed": "rad/s"}
TRUTH = {"J": 0.02, "k": 0.1, "b": 0.05}
NAN = float("nan")


@pytest.fixture(scope="module")
def motor(machines: Path) -> GreyBoxModel:
    return load_model(f"{machines / 'motor.py'}:Motor")


@pytest.fixture(scope="module")
def experiments(motor_speed: Any) -> list[dict[str, np.ndarray]]:
    """Two noise-free experiments of different length, starting at 2 and −1 rad/s."""
    rng = np.random.default_rng(0)
    volts = [np.repeat(rng.uniform(-5, 5, n // 20), 20) for n in (400, 240)]
    return [{"voltage": v, "speed": motor_speed(v, start=s)} for v, s in zip(volts, (2.0, -1.0), strict=True)]


def problem_of(data: DataSet, model: GreyBoxModel) -> Problem:
    return make_problem(data, model, data.estimation())


def noisy(experiments: list[dict[str, np.ndarray]]) -> list[dict[str, np.ndarray]]:
    rng = np.random.default_rng(1)
    return [{**e, "speed": e["speed"] + rng.normal(0, 0.1, len(e["speed"]))} for e in experiments]


def values(found: Estimation) -> dict[str, float]:
    return dict(zip(found.problem.names, map(float, found.problem.values), strict=True))


def test_recovers_the_parameters(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    lines: list[tuple[str, int, float]] = []
    found = fit_records(problem_of(data_set(UNITS, experiments), motor), progress=lambda *line: lines.append(line))
    assert found.termination.succeeded
    assert values(found) == pytest.approx(TRUTH, rel=1e-5)
    np.testing.assert_allclose(found.problem.initial[:, 0], [2.0, -1.0], atol=1e-4)
    assert found.mse < 1e-8
    assert found.samples == 640
    assert [mse for *_, mse in lines] == sorted((mse for *_, mse in lines), reverse=True)
    assert [i for _, i, _ in lines] == list(range(1, len(lines) + 1))
    assert found.evaluations >= found.iterations >= len(lines) > 2


def test_recovers_the_parameters_from_far_off(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    data = data_set(UNITS, experiments, parameters={"J": {"value": 1.0}, "b": {"value": 2.0}})
    assert values(fit_records(problem_of(data, motor))) == pytest.approx(TRUTH, rel=1e-4)


def test_fixed_parameters_stay(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    found = fit_records(
        problem_of(data_set(UNITS, experiments, parameters={"b": {"value": 0.06, "fixed": True}}), motor)
    )
    assert values(found)["b"] == 0.06
    assert values(found)["k"] == 0.1
    assert list(found.parameter_deviations()) == ["J"]


def test_bounds_are_kept(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    data = data_set(UNITS, experiments, parameters={"J": {"value": 0.04, "lower": 0.03, "upper": 0.05}})
    found = fit_records(problem_of(data, motor))
    assert found.termination.succeeded
    assert values(found)["J"] == 0.03
    free_J = data_set(UNITS, experiments, parameters={"J": {"value": 0.03, "fixed": True}})
    assert values(found)["b"] == pytest.approx(values(fit_records(problem_of(free_J, motor)))["b"], rel=1e-6)


def test_fixed_start_states_stay(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    found = fit_records(
        problem_of(data_set(UNITS, experiments, initial={"speed": {"value": 0.5, "fixed": True}}), motor)
    )
    assert found.problem.initial.tolist() == [[0.5], [0.5]]
    assert found.initial_deviations().tolist() == [[0.0], [0.0]]


def test_start_states_of_the_card(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    data = data_set(UNITS, experiments, initial={"speed": {"value": 0.5}})
    assert problem_of(data, motor).initial.tolist() == [[0.5], [0.5]]
    assert fit_records(problem_of(data, motor)).problem.initial[:, 0] == pytest.approx([2.0, -1.0], abs=1e-4)


def test_nothing_free(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    fixed = {"fixed": True}
    data = data_set(UNITS, experiments, parameters={"J": fixed, "b": fixed}, initial={"speed": {"value": 0.0, **fixed}})
    found = fit_records(problem_of(data, motor))
    assert found.termination is Termination.nothing_free
    assert found.mse == found.fpe > 0
    assert (found.parameter_deviations(), found.uncertainty) == ({}, None)


def test_missing_samples_carry_no_weight(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    """Whatever stood where samples are missing, the estimate is that of the others."""
    holes = np.random.default_rng(5).random(400) < 0.4
    holes[:3] = True
    first = {**experiments[0], "speed": np.where(holes, NAN, experiments[0]["speed"])}
    found = fit_records(problem_of(data_set(UNITS, [first, experiments[1]]), motor))
    assert found.samples == 640 - holes.sum()
    assert values(found) == pytest.approx(TRUTH, rel=1e-5)


def test_final_prediction_error(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    found = fit_records(problem_of(data_set(UNITS, noisy(experiments)), motor))
    d, n = 2 + 2, 640  # J and b, and a start speed for each experiment
    assert found.mse == pytest.approx(0.01, rel=0.15)
    assert found.fpe == pytest.approx(found.mse * (1 + d / n) / (1 - d / n), rel=1e-12)


def test_parameters_that_only_matter_together(machines: Path, experiments: list[Any], data_set: Any) -> None:
    """With k free too, only J / k and b / k are determined: the deviations say so, and the fit is as good."""
    model = load_model(f"{machines / 'motor.py'}:Motor")
    found = fit_records(problem_of(data_set(UNITS, noisy(experiments), parameters={"k": {"fixed": False}}), model))
    assert set(found.parameter_deviations().values()) == {np.inf}
    assert values(found)["J"] / values(found)["k"] == pytest.approx(0.2, rel=0.05)
    assert np.isfinite(found.initial_deviations()).all()


class Runaway(GreyBoxModel):
    """dx/dt = a x: overflows at once where a is large."""

    states = [State("speed", "rad/s", initial=1.0)]
    inputs = [Input("voltage", "V")]
    outputs = [Output("speed", "rad/s")]
    parameters = [Parameter("a", 1e5, unit="1/s")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": p.a * x.speed + 0.0 * u.voltage}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": x.speed}


def test_start_values_that_overflow(experiments: list[Any], data_set: Any) -> None:
    with pytest.raises(NumericalError, match=r"estimating Runaway: failed: the simulation overflows.*try"):
        fit_records(problem_of(data_set(UNITS, experiments), Runaway()))


def test_start_values_whose_long_simulation_overflows(data_set: Any) -> None:
    """Whole records overflow at the start value, short windows do not: the estimate is reached all the same."""
    decay = {"voltage": np.zeros(500), "speed": np.exp(-1.0 * 0.01 * np.arange(500))}
    problem = problem_of(data_set(UNITS, [decay], parameters={"a": {"value": 50.0}}), Runaway())
    assert float(fit_records(problem).problem.values[0]) == pytest.approx(-1.0, rel=1e-4)


def test_start_states_from_the_first_tenth(motor: GreyBoxModel, motor_speed: Any, data_set: Any) -> None:
    """The first tenth decides, whatever the rest of the record says, and parameters are left alone."""
    voltage = np.zeros(300)
    speed = motor_speed(voltage, start=3.0)
    speed[30:] = 99.0
    data = data_set(UNITS, [{"voltage": voltage, "speed": speed}], initial={"speed": {"value": 0.0}})
    problem = problem_of(data, motor).with_values(np.array([0.02, 0.1, 0.05]))
    found = estimate_initial(problem, Simulator.of(motor, ()))
    assert found.initial[0, 0] == pytest.approx(3.0, rel=1e-6)
    assert found.values.tolist() == [0.02, 0.1, 0.05]
    fixed = estimate_initial(problem.with_initial_fixed(), Simulator.of(motor, ()))
    assert fixed.initial[0, 0] == 0.0


def test_comparison(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    data = data_set(UNITS, experiments, roles=["estimation", "validation"], initial={"speed": {"value": 0.0}})
    problem = make_problem(data, motor, data.recordings).with_values(np.array([0.02, 0.1, 0.05]))
    found = compare(problem, data.recordings, Simulator.of(motor, ()))
    assert [(s.experiment, s.role, s.output) for s in found.scores] == [
        ("run 1", "estimation", "speed"),
        ("run 2", "validation", "speed"),
    ]
    assert [s.fit for s in found.scores] == pytest.approx([100.0, 100.0], abs=1e-3)
    assert [run.shape for run in found.simulated] == [(400, 1), (240, 1)]
    as_given = compare(problem, data.recordings, Simulator.of(motor, ()), estimate_starts=False)
    assert max(s.fit for s in as_given.scores) < 99.0


class Double(GreyBoxModel):
    """The motor with its angle as a second output, in a much smaller unit."""

    states = [State("speed", "rad/s", initial="measured"), State("angle", "rev")]
    inputs = [Input("voltage", "V")]
    outputs = [Output("speed", "rad/s"), Output("angle", "rev")]
    parameters = [Parameter("T", 0.3, unit="s", lower=0.0), Parameter("turn", 5.0, unit="rad/rev")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": (2.0 * u.voltage - x.speed) / p.T, "angle": x.speed / p.turn}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": x.speed, "angle": x.angle}


def test_outputs_in_different_units_count_alike(motor_speed: Any, data_set: Any) -> None:
    rng = np.random.default_rng(2)
    voltage = np.repeat(rng.uniform(-5, 5, 30), 20)
    speed = motor_speed(voltage)
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * 0.01)]) / (2 * np.pi)
    units = {"voltage": "V", "speed": "rad/s", "angle": "rev"}
    data = data_set(units, [{"voltage": voltage, "speed": speed, "angle": angle}])
    problem = problem_of(data, Double())
    np.testing.assert_allclose(problem.weights, [1 / speed.std(), 1 / angle.std()])
    found = fit_records(problem)
    assert values(found) == pytest.approx({"T": 0.4, "turn": 2 * np.pi}, rel=1e-3)
    assert found.samples == 1200


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            {"parameters": {"Jay": {"value": 1.0}}},
            r"dataset.toml: \[model.parameters\] Jay: model Motor has no such name",
        ),
        (
            {"parameters": {"J": {"value": -1.0}}},
            r"\[model.parameters\] Parameter 'J': value -1 lies outside its bounds",
        ),
        ({"parameters": {"J": {"upper": 0.001}}}, r"'J': value 0.01 lies outside its bounds \[0, 0.001\]"),
        ({"initial": {"sped": {"value": 1.0}}}, r"\[model.initial\] sped: .* did you mean 'speed'"),
    ],
)
def test_cards_that_do_not_fit_the_model(
    motor: GreyBoxModel, experiments: list[Any], data_set: Any, options: Any, message: str
) -> None:
    with pytest.raises(UserError, match=message):
        problem_of(data_set(UNITS, experiments, **options), motor)


def test_standard_deviations_by_monte_carlo(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    """Estimates from 150 simulated repeats scatter as every one of them says."""
    rng = np.random.default_rng(3)
    exact = problem_of(data_set(UNITS, experiments), motor)
    exact = exact.with_values(np.array([0.02, 0.1, 0.05]), np.array([[2.0], [-1.0]]))
    simulator = Simulator.of(motor, exact.free_names)
    estimates, claims = [], {"plain": [], "sandwich": []}
    for _ in range(150):
        y = exact.records.y + rng.normal(0, 0.2, exact.records.y.shape)
        found = fit_records(replace(exact, records=replace(exact.records, y=y)), simulator=simulator)
        estimates.append([*found.problem.values[[0, 2]], *found.problem.initial[:, 0]])
        for kind, rows in claims.items():
            rows.append([*found.parameter_deviations(kind).values(), *found.initial_deviations(kind)[:, 0]])
    scatter = np.std(estimates, axis=0, ddof=1)
    np.testing.assert_allclose(np.mean(claims["plain"], axis=0), scatter, rtol=0.2)
    np.testing.assert_allclose(np.mean(claims["sandwich"], axis=0), scatter, rtol=0.35)
    np.testing.assert_allclose(
        np.mean(estimates, axis=0), [0.02, 0.05, 2.0, -1.0], atol=4 * scatter.max() / np.sqrt(150)
    )


def test_the_sandwich_allows_for_coloured_noise(motor: GreyBoxModel, experiments: list[Any], data_set: Any) -> None:
    """Where the errors are coloured the plain deviations are far too sure. (Blocks must be longer than the errors remember.)"""
    rng = np.random.default_rng(4)
    exact = problem_of(data_set(UNITS, experiments[:1]), motor)
    exact = exact.with_values(np.array([0.02, 0.1, 0.05]), np.array([[2.0]]))
    simulator = Simulator.of(motor, exact.free_names)
    estimates, plain, sandwich = [], [], []
    for _ in range(60):
        slow = np.convolve(rng.normal(0, 0.2, 400 + 5), np.ones(6) / np.sqrt(6), mode="valid")
        found = fit_records(
            replace(exact, records=replace(exact.records, y=exact.records.y + slow)), simulator=simulator
        )
        estimates.append(found.problem.values[2])
        plain.append(found.parameter_deviations()["b"])
        sandwich.append(found.parameter_deviations("sandwich")["b"])
    scatter = np.std(estimates, ddof=1)
    assert np.mean(plain) < 0.55 * scatter
    assert 0.65 * scatter < np.mean(sandwich) < 1.35 * scatter
