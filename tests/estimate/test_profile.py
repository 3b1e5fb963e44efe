"""Profile likelihoods: exact where the model is linear, honest where it is not."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from greybox_torch.errors import UserError
from greybox_torch.estimate.fit import Estimation, fit_records
from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.levenberg_marquardt import Settings
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.profile import THRESHOLD, Profile, check_profiled, profile
from greybox_torch.model import GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.report.profile import plot_profile
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.systems import load_model

UNITS = {"voltage": "V", "speed": "rad/s"}


class Line(GreyBoxModel):
    """y = a u + b."""

    states = [State("idle", "", initial=0.0, fixed=True)]
    inputs = [Input("voltage", "V")]
    outputs = [Output("speed", "rad/s")]
    parameters = [Parameter("a", 1.0, unit="rad/s/V", upper=3.0), Parameter("b", 0.0, unit="rad/s")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"idle": 0.0 * x.idle}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": p.a * u.voltage + p.b}


@pytest.fixture(scope="module")
def line(data_set: Any) -> Any:
    def fitted(slope: float = 2.0) -> Estimation:
        rng = np.random.default_rng(0)
        volts = rng.uniform(0.0, 1.0, 500)
        speed = slope * volts + 0.5 + rng.normal(0, 0.3, 500)
        data = data_set(UNITS, [{"voltage": volts, "speed": speed}])
        return fit_records(make_problem(data, Line(), data.recordings))

    return fitted


def of(found: Estimation, name: str) -> Profile:
    return profile(found, Simulator.of(found.problem.model, found.problem.free_names), name)


@pytest.mark.parametrize("name", ["a", "b"])
def test_a_linear_model_has_a_parabola(line: Any, name: str) -> None:
    """The rise is ((θ − θ̂) / std)² with the standard deviation that allows for coloured residuals, and so is the interval."""
    result = line()
    found = of(result, name)
    deviation = result.parameter_deviations("sandwich")[name]
    plain = result.parameter_deviations()[name]
    assert found.colour == pytest.approx((deviation / plain) ** 2)
    np.testing.assert_allclose(found.rise, ((found.values - found.estimate) / deviation) ** 2, rtol=1e-4, atol=1e-6)
    reach = np.sqrt(THRESHOLD) * deviation
    assert (found.lower, found.upper) == pytest.approx((found.estimate - reach, found.estimate + reach), rel=1e-5)
    assert not found.lower_bound
    assert not found.upper_bound
    assert (np.diff(found.values) > 0).all()
    assert len(found.values) > 8
    assert found.sentence.startswith(f"{name}: {found.lower:.5g} rad/s")


def test_a_bound_within_the_interval(line: Any) -> None:
    found = of(line(slope=2.97), "a")
    assert found.upper_bound
    assert found.upper == np.inf
    assert found.values[-1] == 3.0
    assert found.lower < found.estimate
    assert "no upper end: the cost stays within the 95 % level up to 3 rad/s/V, its bound" in found.sentence


def test_what_only_ratios_determine_is_open(machines: Path, motor_speed: Any, data_set: Any) -> None:
    """Raising k raises J and b with it: the cost does not rise until b meets its bound, at k = b_max · (k/b)."""
    rng = np.random.default_rng(1)
    voltage = np.repeat(rng.uniform(-5, 5, 15), 20)
    speed = motor_speed(voltage) + rng.normal(0, 0.1, 300)
    free = {"k": {"fixed": False}, "b": {"upper": 0.1, "value": 0.06}}
    data = data_set(UNITS, [{"voltage": voltage, "speed": speed}], parameters=free)
    result = fit_records(make_problem(data, load_model(f"{machines / 'motor.py'}:Motor"), data.recordings))
    simulator = Simulator.of(result.problem.model, result.problem.free_names)
    found = profile(result, simulator, "k", settings=Settings(iterations=5, tolerance=1e-4))
    assert found.upper == pytest.approx(0.1 * 2.0, rel=0.1)
    inside = (found.values > 0) & (found.values < 0.95 * found.upper)
    assert np.abs(found.rise[inside]).max() < 0.1


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        (
            "gian",
            r"profiles: found 'gian', model Motor has no parameter of that name \(did you mean \"gain\"\?\); expected .*: J, b",
        ),
        ("k", r"profiles: found 'k', this parameter is fixed; expected one of the free parameters: J, b"),
    ],
)
def test_names_that_cannot_be_profiled(name: str, expected: str) -> None:
    with pytest.raises(UserError, match=expected):
        check_profiled([name], ["J", "b"], ["J", "k", "b", "gain"], "Motor")


def test_figure(line: Any, tmp_path: Path) -> None:
    plot_profile(of(line(), "a"), "profile of a").savefig(tmp_path / "profile.png")
    assert (tmp_path / "profile.png").stat().st_size > 5000


def test_an_estimate_that_is_no_optimum_has_no_interval(line: Any) -> None:
    """Seen: "up to 805" around an estimate whose cost lay 590 above that at 0, shaded as its 95 % interval."""
    found = line()
    problem = found.problem.with_values(np.array([1.0, 1.0]))
    run = FreeRun(problem, Simulator.of(problem.model, problem.free_names))
    at_start = run.quadratic(run.start)
    assert at_start is not None
    away = replace(found, problem=problem, mse=2 * at_start.cost / found.samples)
    profiled = of(away, "a")
    assert profiled.better is not None and profiled.rise.min() < -THRESHOLD
    assert (profiled.lower, profiled.upper) == (-np.inf, np.inf)
    assert profiled.sentence.startswith("a: no interval: the estimate of 1 rad/s/V is no optimum, at ")
    assert f"a = {{ value = {profiled.better:.5g} }}" in profiled.sentence
    labels = [text.get_text() for text in plot_profile(profiled, "").legends[0].get_texts()]
    assert "95 % interval" not in labels and "lower cost: no interval" in labels
