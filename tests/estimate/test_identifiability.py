"""What the data do not determine, on models where that can be said beforehand."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from hypothesis import example, given, settings
from hypothesis import strategies as st

from greybox_torch.data import DataSet
from greybox_torch.estimate.fit import fit_records
from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.identifiability import Unidentifiable, identifiability
from greybox_torch.estimate.information import echelon
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.estimate.termination import Outcome, Termination
from greybox_torch.model import GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.simulator import SimulationOptions, Simulator
from greybox_torch.systems import load_model

UNITS = {"voltage": "V", "speed": "rad/s"}
SIZES = st.floats(0.01, 100.0)


class Lag(GreyBoxModel):
    """T dω/dt = gain v − ω, with the gain made of several parameters by those who inherit."""

    states = [State("speed", "rad/s", initial="measured")]
    inputs = [Input("voltage", "V")]
    outputs = [Output("speed", "rad/s")]
    parameters = [Parameter("T", 0.3, unit="s", lower=1e-3), Parameter("a", 2.0), Parameter("b", 3.0)]

    def gain(self, x: Any, u: Any, p: Any) -> Any:
        raise NotImplementedError

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": (self.gain(x, u, p) - x.speed) / p.T}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": x.speed}


class Product(Lag):
    def gain(self, x: Any, u: Any, p: Any) -> Any:
        return p.a * p.b * u.voltage


class Power(Lag):
    def gain(self, x: Any, u: Any, p: Any) -> Any:
        return p.a * p.b**2 * u.voltage


class Sum(Lag):
    def gain(self, x: Any, u: Any, p: Any) -> Any:
        return (p.a + p.b) * u.voltage


class Difference(Lag):
    def gain(self, x: Any, u: Any, p: Any) -> Any:
        return (p.a - p.b) * u.voltage


class OneUnused(Lag):
    def gain(self, x: Any, u: Any, p: Any) -> Any:
        return p.a * u.voltage


class OnlyFast(Lag):
    """The second parameter acts beyond 50 V only."""

    def gain(self, x: Any, u: Any, p: Any) -> Any:
        return p.a * u.voltage + p.b * torch.relu(u.voltage - 50.0)


class Shape(Lag):
    """The first parameter is the amplitude of what the second shapes."""

    def gain(self, x: Any, u: Any, p: Any) -> Any:
        return u.voltage + p.a * torch.tanh(p.b * x.speed)


class Faint(Lag):
    """The second parameter does very little."""

    def gain(self, x: Any, u: Any, p: Any) -> Any:
        return p.a * u.voltage + 1e-5 * p.b * torch.sin(u.voltage)


class Offset(Lag):
    """A position whose sensor has an unknown offset: it and the position at the start cannot be told apart."""

    states = [State("speed", "rad/s", initial="measured"), State("angle", "rad")]
    outputs = [Output("speed", "rad/s"), Output("angle", "rad")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"speed": (p.a * u.voltage - x.speed) / p.T, "angle": x.speed}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": x.speed, "angle": x.angle + p.b}


@pytest.fixture(scope="module")
def experiments(motor_speed: Any) -> list[dict[str, np.ndarray]]:
    rng = np.random.default_rng(0)
    volts = [np.repeat(rng.uniform(-5, 5, n // 20), 20) for n in (400, 240)]
    return [{"voltage": v, "speed": motor_speed(v) + rng.normal(0, 0.1, len(v))} for v in volts]


def problem_of(data: DataSet, model: GreyBoxModel) -> Problem:
    return make_problem(data, model, data.estimation())


def found_in(problem: Problem, precision: str = "double", **values: float) -> tuple[Unidentifiable, ...]:
    numbers = [values.get(n, v) for n, v in zip(problem.names, problem.values, strict=True)]
    problem = problem.with_values(np.array(numbers))
    run = FreeRun(problem, Simulator.of(problem.model, problem.free_names, SimulationOptions(precision=precision)))
    return identifiability(run, run.start)


@pytest.mark.parametrize("precision", ["double", "single"])
@given(inertia=SIZES, gain=SIZES, damping=SIZES)
@example(inertia=44.160000000000004, gain=0.010000000000000002, damping=64.0)
@example(inertia=100.0, gain=0.01, damping=100.0)
@example(inertia=0.01, gain=0.01, damping=100.0)
@settings(max_examples=12)
def test_gain_inertia_and_friction_only_up_to_a_factor(
    machines: Path, experiments: list[Any], data_set: Any, precision: str, inertia: float, gain: float, damping: float
) -> None:
    """Wherever one starts with a motor that is neither instantaneous nor an integrator on these data."""
    inertia = damping * (0.05 + inertia / 100)
    model = load_model(f"{machines / 'motor.py'}:Motor")
    problem = problem_of(data_set(UNITS, experiments, parameters={"k": {"fixed": False}}), model)
    found = [w for w in found_in(problem, precision, J=inertia, k=gain, b=damping) if w.kind != "weak"]
    assert [(w.kind, w.parameters) for w in found] == [("together", ("J", "k", "b"))]
    np.testing.assert_allclose(found[0].direction, 1.0, rtol=1e-3 if precision == "double" else 0.1)
    assert found[0].undetermined
    if precision == "double":
        assert found[0].sentence == (
            "J, k and b: only their ratios are determined (raising all by the same factor changes nothing); "
            "fix one of them, or measure it by other means"
        )


def test_nothing_to_say_of_a_sound_problem(machines: Path, experiments: list[Any], data_set: Any) -> None:
    model = load_model(f"{machines / 'motor.py'}:Motor")
    assert found_in(problem_of(data_set(UNITS, experiments), model)) == ()


@pytest.mark.parametrize(
    ("model", "direction", "expected"),
    [
        (Product(), (1.0, -1.0), "only their product is determined (raising a and lowering b by the same factor"),
        (Power(), (1.0, -0.5), "only products of their powers are determined (multiplying a by c^2 and b by 1/c"),
        (Sum(), (1.0, -2 / 3), "only their sum is determined (raising a and lowering b by as much changes nothing)"),
        (Difference(), (1.0, 2 / 3), "only their difference is determined (raising a and raising b by as much"),
    ],
)
def test_pairs(
    experiments: list[Any], data_set: Any, model: GreyBoxModel, direction: tuple[float, ...], expected: str
) -> None:
    (found,) = found_in(problem_of(data_set(UNITS, experiments), model))
    assert (found.kind, found.parameters) == ("together", ("a", "b"))
    np.testing.assert_allclose(found.direction, direction, rtol=1e-3)
    assert found.sentence.startswith(f"a and b: {expected}")


def test_equal_values_do_not_make_a_sum_a_product(experiments: list[Any], data_set: Any) -> None:
    (found,) = found_in(problem_of(data_set(UNITS, experiments), Sum()), a=2.0, b=2.0)
    assert "only their sum is determined" in found.sentence


@pytest.mark.parametrize("model", [OneUnused(), OnlyFast()])
def test_what_no_recording_shows(experiments: list[Any], data_set: Any, model: GreyBoxModel) -> None:
    """Not at all, as against weakly: neither an unused parameter, nor one of a range that is never visited."""
    problem = problem_of(data_set(UNITS, experiments), model)
    (found,) = found_in(problem)
    assert (found.kind, found.parameters) == ("unmoved", ("b",))
    assert "nothing in these recordings depends on it" in found.sentence
    fitted = fit_records(problem)
    assert fitted.parameter_deviations()["b"] == np.inf
    assert np.isfinite(fitted.parameter_deviations()["a"])
    assert [note.kind for note in fitted.notes] == [Termination.rank_deficient]
    assert "(b)" in fitted.notes[0].sentence


def test_where_it_starts_is_to_blame(experiments: list[Any], data_set: Any) -> None:
    """A shape without effect while its amplitude is zero; the amplitude itself, zero too, is seen by the data."""
    (found,) = found_in(problem_of(data_set(UNITS, experiments), Shape()), a=0.0)
    assert (found.kind, found.parameters, found.undetermined) == ("start", ("b",), False)
    assert found.sentence.startswith("b: has no effect at these values while a is zero, but it has elsewhere")
    assert found_in(problem_of(data_set(UNITS, experiments), Shape()), a=-0.5) == ()


def test_an_amplitude_known_to_be_zero_is_not(experiments: list[Any], data_set: Any) -> None:
    data = data_set(UNITS, experiments, parameters={"a": {"value": 0.0, "fixed": True}})
    (found,) = found_in(problem_of(data, Shape()))
    assert (found.kind, found.parameters) == ("unmoved", ("b",))


def test_what_is_weak_is_not_said_to_be_lost(experiments: list[Any], data_set: Any) -> None:
    problem = problem_of(data_set(UNITS, experiments), Faint())
    (found,) = found_in(problem)
    assert (found.kind, found.parameters, found.undetermined) == ("weak", ("b",), False)
    assert "weakly determined, its standard deviation is about" in found.sentence
    assert np.isfinite(fit_records(problem).parameter_deviations()["b"])


def test_parameters_and_start_states(experiments: list[Any], data_set: Any) -> None:
    """Two experiments: raising the offset by one is the same as lowering the angle at the start of both."""
    units = {**UNITS, "angle": "rad"}
    turned = [{**e, "angle": 0.7 + np.cumsum(e["speed"]) * 0.01} for e in experiments]
    (found,) = found_in(problem_of(data_set(units, turned), Offset()))
    assert found.kind == "together"
    assert found.parameters == ("b", "angle at the start of 'run 1'", "angle at the start of 'run 2'")
    assert "cannot be told apart" in found.sentence


def test_a_start_that_overflows_is_left_to_the_fit(experiments: list[Any], data_set: Any) -> None:
    assert found_in(problem_of(data_set(UNITS, experiments), Product()), T=-1e-4) == ()


@given(st.integers(0, 2**31), st.integers(1, 3), st.integers(1, 3))
def test_echelon_form_keeps_apart_what_has_nothing_to_do_with_each_other(seed: int, first: int, second: int) -> None:
    """However a null space of two blocks is turned, every row of its echelon form lies in one block, and they span the same."""
    rng = np.random.default_rng(seed)
    rows = np.zeros((first + second, 12))
    rows[:first, :6], rows[first:, 6:] = rng.standard_normal((first, 6)), rng.standard_normal((second, 6))
    turned = np.linalg.qr(rng.standard_normal((first + second, first + second)))[0] @ rows
    found = echelon(turned)
    assert all(not row[:6].any() or not row[6:].any() for row in found)
    assert np.linalg.matrix_rank(np.vstack([found, rows]), tol=1e-3) == first + second


@pytest.mark.parametrize("kind", list(Termination))
def test_sentences_carry_their_detail_before_what_to_try(kind: Termination) -> None:
    plain, detailed = Outcome(kind).sentence, Outcome(kind, "J and b").sentence
    assert plain == kind.value
    assert detailed.replace(" (J and b)", "") == plain
    optima = (Termination.converged, Termination.small_step, Termination.nothing_free)
    assert kind in optima or "try" in plain
