"""Where a position begins that nothing measures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm.held_out import HeldOut, _window_by_window
from greybox_torch.diagnosis.hypothesis.fit import augmented
from greybox_torch.diagnosis.hypothesis.start_positions import placed
from greybox_torch.diagnosis.settings import DiagnosisSettings, SearchBudget
from greybox_torch.estimate.initial import estimate_initial
from greybox_torch.estimate.problem import problem_for
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.simulation.simulator import Simulator

SETTINGS, BUDGET = DiagnosisSettings(), SearchBudget()

BEGINS = 0.4
"""Position at which the simulated motor begins, rad."""


def restated(search, effect, **values):
    model = augmented(search.problem, (effect,), search.surroundings)
    known = {
        **search.problem.model.values(),
        "J": 0.02,
        "b": 0.05,
        **{f"{effect.prefix}.{n}": v for n, v in values.items()},
    }
    problem = problem_for(search.problem, model, known)
    return problem.fixed, Simulator.of(model)


@pytest.mark.parametrize("samples", [2000, 2020])  # of the second, the last window is longer than the others
def test_position_is_found_along_a_period(motor_data, motor, begun, samples) -> None:
    order, phase = 5.0, 0.7
    search = begun(motor_data(samples, torque=lambda q, v: 0.03 * np.cos(order * q + phase)), motor)
    ripple = attach(motor, "rotor", TorqueRipple(order))
    size = {"a": 0.03 * np.cos(phase), "b": -0.03 * np.sin(phase), "order": order}
    problem, simulator = restated(search, ripple, **size)
    fit = placed(problem, simulator, 31, BUDGET)
    assert fit is not None
    found = fit.problem.initial[0, 1]
    period = 2 * np.pi / order
    assert (found - BEGINS + period / 2) % period - period / 2 == pytest.approx(0.0, abs=0.03)
    assert np.sqrt(fit.mean_square) == pytest.approx(0.02, rel=0.1), "what is left is noise"


def test_without_a_position_it_is_a_fit_of_the_windows(motor_data, motor, begun) -> None:
    search = begun(motor_data(torque=lambda q, v: 0.05), motor)
    problem, simulator = restated(search, attach(motor, "rotor", ConstantBias()), bias=0.05)
    fit = placed(problem, simulator, 31, BUDGET)
    assert fit is not None and fit.problem.initial.shape == (1, 1)
    assert np.sqrt(fit.mean_square) == pytest.approx(0.02, rel=0.1)


def test_a_window_in_a_local_minimum_does_not_outweigh_the_others(motor_data, motor, begun) -> None:
    search = begun(motor_data(), motor)
    good = search.plain.fits[0]
    energies, starts = good.energies.copy(), good.starts.copy()
    energies[3], starts[3] = 1e3, 99.0
    stuck = replace(
        good, energies=energies, starts=starts, mean_square=good.mean_square * energies.sum() / good.energies.sum()
    )
    for pair in ((stuck, good), (good, stuck)):
        best = _window_by_window(*pair)
        assert best is not None
        assert np.array_equal(best.energies, good.energies) and np.array_equal(best.starts, good.starts)
        assert best.mean_square == pytest.approx(good.mean_square)
    assert _window_by_window(None, good) is good and _window_by_window(good, None) is good
    assert _window_by_window(None, None) is None


@pytest.mark.parametrize(("size", "taken"), [(0.0, True), (0.1, False)])
def test_a_place_known_otherwise_is_taken_where_the_beginning_says_nothing_else(
    motor_data, motor, begun, size, taken
) -> None:
    """Seen: a notch that an arm passes late; its start position on another experiment, from the first tenth, was one of many alike."""
    search = begun(motor_data(torque=lambda q, v: size * np.cos(5.0 * q)), motor)
    problem, simulator = restated(search, attach(motor, "rotor", TorqueRipple(5.0)), a=size, b=0.0, order=5.0)
    name = problem.records.names[0]
    found = estimate_initial(problem, simulator, places={name: {"rotor.position": 1.0}})
    alone = estimate_initial(problem, simulator)
    if taken:
        assert found.initial[0, 1] == 1.0 and found.initial[0, 0] == pytest.approx(alone.initial[0, 0], abs=1e-3)
    else:
        np.testing.assert_array_equal(found.initial, alone.initial)
        away = (found.initial[0, 1] - BEGINS) % (2 * np.pi / 5.0)
        assert min(away, 2 * np.pi / 5.0 - away) < 0.05
    np.testing.assert_array_equal(estimate_initial(problem, simulator, places={"another": {}}).initial, alone.initial)


def test_held_out_windows_tell_where_positions_begin(motor_data, motor, begun) -> None:
    data = motor_data(torque=lambda q, v: 0.05 * np.cos(5.0 * q))
    search = begun(data, motor)
    ripple = attach(motor, "rotor", TorqueRipple(5.0))
    values = search.plain.values() | {f"{ripple.prefix}.a": 0.05, f"{ripple.prefix}.b": 0.0}
    others = HeldOut(data, search.study)
    found = search.refitted((ripple,), search.plain, [values])
    assert others.places(found) == {}, "nobody asked yet: it is not fitted for this"
    others.fits(found)
    placed_at = others.places(found)
    (name,) = (r.name for r in data.validation())
    assert set(placed_at) == {name} and set(placed_at[name]) == {"rotor.position"}
    assert others.places(search.plain) == {}
