"""Which start states of windows are estimated."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from greybox_torch.estimate.open_starts import begun_with, open_starts
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.estimate.window_fit import evaluate, fit_windows
from greybox_torch.estimate.window_information import window_information
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.surroundings import Range, Surroundings
from greybox_torch.mechanisms.unknown_fading import UnknownFading
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.simulator import SimulationOptions, Simulator
from greybox_torch.simulation.windows import cut

LENGTH, SPEED, USED = 50, 0, 1
VALUES = {"change": -0.5, "T": 1.0, "q": 0.5}


@pytest.fixture(scope="module")
def problem(data_set, motor) -> Problem:
    """Two experiments of a motor whose gain fades, by a model that says so; nothing of the motor itself is estimated."""
    rng = np.random.default_rng(0)
    experiments = [{"voltage": np.repeat(rng.uniform(-1, 1, 10), 20), "speed": np.zeros(200)} for _ in range(2)]
    around = Surroundings({"input": Range(-1.0, 1.0, 0.5), "time": Range(0.0, 2.0, 1.0)}, {"input": "V"}, "V", 0.01)
    fading = attach(motor, "actuator", UnknownFading("input"))
    model = AugmentedModel(motor, [fading], {q.name: around for q in motor.all_ports})
    model.set_values({f"{fading.prefix}.{name}": value for name, value in VALUES.items()})
    data = data_set({"voltage": "V", "speed": "rad/s"}, experiments, sample_time=0.01)
    return make_problem(data, model, data.recordings)


def test_what_a_model_remembers_is_open_where_a_record_begins(problem) -> None:
    windows = cut(problem.records, LENGTH)
    begun = open_starts(problem, windows)
    assert begun.states.tolist() == [SPEED, USED] and problem.carried.tolist() == [False, True]
    first = np.isin(windows.start, problem.records.first)
    assert first.sum() == 2
    np.testing.assert_array_equal(begun.bound, np.stack([np.zeros_like(first), ~first], axis=1))
    np.testing.assert_array_equal(begun.directions[:, USED, USED], first.astype(float))
    assert (begun.directions[:, SPEED, SPEED] == 1.0).all()


def test_without_such_a_memory_carried_states_are_closed(problem) -> None:
    states = problem.model.states
    plain: Any = SimpleNamespace(model=SimpleNamespace(states=states, remembered_states=tuple))
    plain.carried, plain.records = problem.carried, problem.records
    begun = open_starts(plain, cut(problem.records, LENGTH))
    assert begun.states.tolist() == [SPEED] and not begun.bound.any()
    curvature = np.ones((len(begun.bound), 1, 1))
    assert begun.without_bound(curvature) is curvature
    assert begun_with(plain, cut(problem.records, LENGTH), np.ones((8, 2))) is plain


def test_its_slope_is_that_of_differences(problem) -> None:
    simulator = Simulator.of(problem.model, (), SimulationOptions())
    windows, fixed = cut(problem.records, LENGTH), problem.fixed
    starts = np.tile([0.3, 0.4], (len(windows.start), 1))

    def half_energies(used: float) -> np.ndarray:
        moved = starts.copy()
        moved[:, USED] = used
        found = evaluate(fixed, simulator, windows, moved)
        assert found is not None
        return 0.5 * found.energies

    found = evaluate(fixed, simulator, windows, starts)
    assert found is not None
    differences = (half_energies(0.4 + 1e-5) - half_energies(0.4 - 1e-5)) / 2e-5
    own = ~found.bound[:, USED]
    assert np.abs(differences).min() > 1e-6, "it moves what is simulated in every window"
    np.testing.assert_allclose(found.gs[own, USED], differences[own], rtol=1e-5)
    assert not found.gs[~own, USED].any() and (found.hss[~own, USED, USED] > 0).all()


def test_a_fit_finds_what_each_record_begins_with(problem) -> None:
    """The model's own simulation, begun with half of the memory and with a fifth of it."""
    fixed, begins = Simulator.of(problem.model, (), SimulationOptions()), [0.5, 0.2]
    whole = cut(problem.records, 200)
    asked = Pass(whole, problem.values, np.array([[0.0, used] for used in begins]))
    run = fixed.run(problem.driving_records, asked)
    measured = np.concatenate([run.y[w, :200].T for w in range(2)], axis=1)
    there = replace(problem, records=replace(problem.records, y=measured))
    fit = None
    for length in (25, 50, 100, 200):
        fit = fit_windows(there.fixed, fixed, length, shorter=fit)
        assert fit is not None
    np.testing.assert_allclose(fit.problem.initial[:, USED], begins, atol=1e-3)


def test_windows_tell_of_the_parameters_beside_it(problem) -> None:
    """Starts that are bound leave no window without curvature."""
    simulator = Simulator.of(problem.model, problem.free_names, SimulationOptions())
    fit = fit_windows(problem, simulator, LENGTH)
    assert fit is not None
    information = window_information(fit, simulator)
    assert information is not None and np.isfinite(information).all()
