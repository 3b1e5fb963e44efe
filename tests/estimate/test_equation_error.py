"""Parameters and missing forces from a motion that is known exactly: nothing is simulated, so the answers are known as well."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from greybox_torch.estimate.averaging import stretches
from greybox_torch.estimate.equation_error import EquationError
from greybox_torch.estimate.motion_equations import MotionEquations
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.reconstruction import Motion, reconstructed
from greybox_torch.model import GreyBoxModel
from greybox_torch.systems.load import load_model


@pytest.fixture(scope="module")
def sled(machines: Path) -> GreyBoxModel:
    return load_model(f"{machines / 'sled.py'}:Sled")


@pytest.fixture(scope="module")
def equations(sled, sled_run) -> MotionEquations:
    data = sled_run()
    problem = make_problem(data, sled, data.estimation())
    motion = reconstructed(problem)
    assert isinstance(motion, Motion)
    return MotionEquations.of(problem, motion)


def test_only_equations_in_which_something_may_be_missing_count(equations) -> None:
    assert equations.rows == (1,), "the position's rate is the speed, whatever the parameters"


@pytest.mark.parametrize("inverse", [False, True])
def test_parameters_are_found_in_either_form(equations, inverse: bool) -> None:
    finest = stretches(equations.motion)
    for coarser in (None, finest.coarser(4)):
        found = EquationError.of(equations, finest, coarser, inverse).settled()
        assert found is not None
        assert found.problem.values == pytest.approx([2.5, 0.8], rel=0.02)


def test_parameters_stay_within_their_bounds(equations) -> None:
    problem = replace(equations.problem, upper=np.array([2.0, 10.0]))
    found = EquationError.of(replace(equations, problem=problem), stretches(equations.motion), None, False).fitted()
    assert found is not None
    assert found.problem.values[0] == 2.0


def test_slopes_are_those_of_the_equations(equations) -> None:
    mass, damping = 2.5, 0.8
    error, slopes = equations.linearised(np.array([mass, damping]), inverse=False)
    u, v = equations.inputs.numpy()[0], equations.states.numpy()[1]
    assert error[0] == pytest.approx(equations.motion.rates[1] - (u - damping * v) / mass)
    assert slopes[0, 0] == pytest.approx((u - damping * v) / mass**2, rel=1e-5, abs=1e-6)
    assert slopes[1, 0] == pytest.approx(v / mass, rel=1e-5, abs=1e-6)


def test_slopes_of_what_acts_are_those_of_the_equation_of_motion(equations) -> None:
    """The mass changes what an input does, the damping has no part in that: found at the first look, and used at the next ones."""
    afresh = replace(equations, beside_inputs={})
    u, v, a = equations.inputs.numpy()[0], equations.states.numpy()[1], equations.motion.rates[1]
    for mass, damping in ((2.5, 0.8), (1.5, 2.0)):
        error, slopes = afresh.linearised(np.array([mass, damping]), inverse=True)
        assert error[0] == pytest.approx(mass * a + damping * v - u)
        assert slopes[0, 0] == pytest.approx(a, rel=1e-3, abs=1e-3)
        assert slopes[1, 0] == pytest.approx(v, rel=1e-5, abs=1e-5)
    mass_name, damping_name = equations.problem.free_names
    assert afresh.beside_inputs == {mass_name: False, damping_name: True}


def test_a_force_acts_by_one_over_the_mass_and_so_does_the_input(equations) -> None:
    at = equations.at(np.array([2.5, 0.8]))
    assert at.force_slopes("sled") == pytest.approx(0.4)
    assert at.input_slopes[0, 0] == pytest.approx(0.4)
    assert at.invertible
    assert at.in_inputs(np.full((1, len(at.motion.dt)), 2.0), at.input_slopes) == pytest.approx(5.0)


def test_smallest_inputs_that_two_equations_ask_for(equations) -> None:
    both = replace(equations, rows=(0, 1))
    slopes = np.moveaxis(np.array([[[1.0, 2.0, 0.0], [0.0, 1.0, 1.0]]]), 0, -1)  # (2, 3, 1)
    rates = np.array([[[3.0], [1.0]], [[1.0], [2.0]]])  # two looks at once, (2, 2, 1)
    found = both.in_inputs(rates, slopes)
    for look, wanted in zip(found, rates, strict=True):
        assert slopes[..., 0] @ look[:, 0] == pytest.approx(wanted[:, 0])
        assert look[:, 0] == pytest.approx(np.linalg.lstsq(slopes[..., 0], wanted[:, 0], rcond=None)[0])


def test_where_a_model_has_no_input_of_its_own_there_is_no_inverse_form(sled_run, machines) -> None:
    class Blown(type(load_model(f"{machines / 'sled.py'}:Sled"))):  # type: ignore[misc]
        def derivative(self, x, u, p, port):
            return {"q": x.v, "v": (-p.c * x.v + port.sled) / p.m + 0.0 * u.F}

    data = sled_run()
    problem = make_problem(data, Blown(), data.estimation())
    motion = reconstructed(problem)
    assert isinstance(motion, Motion)
    assert not MotionEquations.of(problem, motion).invertible
