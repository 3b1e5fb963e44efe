"""Experiments fitted together, each begun where its position is beside the others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.diagnosis.hypothesis.common_positions import begun_as, placed_alike, with_common_positions
from greybox_torch.diagnosis.hypothesis.fit import augmented
from greybox_torch.diagnosis.hypothesis.start_positions import placed
from greybox_torch.diagnosis.settings import SearchBudget
from greybox_torch.estimate.problem import problem_for
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.simulation.simulator import Simulator

from ..conftest import STEP

ORDER, SIZE, BEGINS = 4.0, 0.04, (0.0, 0.9, 0.4)
PERIOD = 2 * np.pi / ORDER


def turning(voltage: np.ndarray, begins: float, substeps: int = 4) -> np.ndarray:
    """The documentation's motor with a ripple, its angle beginning at ``begins`` rad; Euler steps, fine."""
    q, v, speeds, h = begins, 0.0, [], STEP / substeps / 5
    for u in voltage:
        speeds.append(v)
        for _ in range(5 * substeps):
            q, v = q + h * v, v + h * (0.1 * u - 0.05 * v + SIZE * np.cos(ORDER * q)) / 0.02
    return np.array(speeds)


@pytest.fixture(scope="module")
def search(data_set, motor, begun):
    rng, experiments = np.random.default_rng(2), []
    for begins in BEGINS:
        voltage = np.repeat(rng.uniform(-3, 3, 50), 20)
        experiments.append({"voltage": voltage, "speed": turning(voltage, begins) + rng.normal(0, 0.02, 1000)})
    return begun(data_set({"voltage": "V", "speed": "rad/s"}, experiments, sample_time=STEP), motor)


def apart(initial: np.ndarray) -> np.ndarray:
    """How far the positions (E,) are from the true ones beside the first, in periods."""
    beside = (initial - initial[0]) - (np.array(BEGINS) - BEGINS[0])
    return np.abs((beside / PERIOD + 0.5) % 1.0 - 0.5)


def test_a_ripple_of_several_experiments_has_one_phase(motor, search) -> None:
    """Seen: torque ripple of an arm's motor, two experiments to estimate from: order 4.996 for 5, twelve times the noise left."""
    ripple = attach(motor, "rotor", TorqueRipple(ORDER))
    start = search.plain.values() | {f"{ripple.prefix}.a": 0.01, f"{ripple.prefix}.b": 0.01}
    found = search.refitted((ripple,), search.plain, [start])
    values = found.values()
    assert np.hypot(values[f"{ripple.prefix}.a"], values[f"{ripple.prefix}.b"]) == pytest.approx(SIZE, rel=0.05)
    assert values[f"{ripple.prefix}.order"] == pytest.approx(ORDER, rel=0.01)
    assert all(np.sqrt(fit.mean_square) < 1.2 * 0.02 for fit in found.fits), "what is left is noise"
    assert apart(found.problem.initial[:, 1]).max() < 0.03
    again = search.refitted((ripple, attach(motor, "rotor", ConstantBias())), found)
    assert apart(again.problem.initial[:, 1]).max() < 0.03, "what is known of it is not forgotten"


def test_a_place_that_a_poorer_law_had_is_looked_for_along_the_whole_period(motor, search) -> None:
    """Seen: friction along a spindle's turn in the place of its cogging, one experiment a third of a period from where it belongs."""
    ripple = attach(motor, "rotor", TorqueRipple(ORDER))
    start = search.plain.values() | {f"{ripple.prefix}.a": SIZE, f"{ripple.prefix}.b": 0.0}
    right = search.refitted((ripple,), search.plain, [start]).fits[0]
    initial = right.problem.initial.copy()
    initial[1, 1] += 0.45 * PERIOD
    wrong = replace(right, problem=replace(right.problem, initial=initial))
    simulator = Simulator.of(right.problem.model, right.problem.free_names)
    ((problem,), _) = with_common_positions([right.problem], [], simulator, 62, [wrong], SearchBudget(), False)
    assert apart(problem.initial[:, 1]).max() < 0.03


def test_a_refit_begins_where_its_experiments_were_placed(motor, search) -> None:
    """Seen: the teeth of a winder's motor: placed anew by every refit, which took its start states from the fit before, 2.3 times the
    noise was left; a sheet's transmission error and another drum's ripple were told for it."""
    ripple = attach(motor, "rotor", TorqueRipple(ORDER))
    start = search.plain.values() | {f"{ripple.prefix}.a": SIZE, f"{ripple.prefix}.b": 0.0}
    right = search.refitted((ripple,), search.plain, [start])
    fit, away = right.fits[0], np.array([0.0, 0.3 * PERIOD, 0.0])
    experiments = fit.problem.records.experiments(fit.windows.start)
    starts, initial = fit.starts.copy(), fit.problem.initial.copy()
    starts[:, 1] += away[experiments]
    initial[:, 1] += away
    wrong = replace(fit, starts=starts, problem=replace(fit.problem, initial=initial), along=starts)
    moved = begun_as(fit.problem, wrong)
    assert moved is not None and moved.along is None
    np.testing.assert_allclose(moved.starts, fit.starts, atol=1e-9)
    assert placed_alike(fit.problem, fit.problem) and not placed_alike(fit.problem, wrong.problem)
    assert begun_as(search.plain.problem, wrong) is wrong, "positions that the model does not have are nobody's"
    again = search.refitted((ripple,), replace(right, fits=(wrong, *right.fits[1:])))
    assert all(np.sqrt(f.mean_square) < 1.2 * 0.02 for f in again.fits), "what is left is noise"


def test_the_experiment_that_the_law_was_fitted_to_begins_where_it_did(motor, search) -> None:
    """Its place and the law's say the same: moved by what short windows leave, it would take the law along to a wrong place."""
    ripple = attach(motor, "rotor", TorqueRipple(ORDER))
    start = search.plain.values() | {f"{ripple.prefix}.a": SIZE, f"{ripple.prefix}.b": 0.0}
    found = search.refitted((ripple,), search.plain, [start])
    problem = found.fits[0].problem.fixed
    turned = problem.initial.copy()
    turned[:, 1] = [0.3 * PERIOD, 0.0, 0.0]
    problem = replace(problem, initial=turned)
    for kept in range(len(BEGINS)):
        fit = placed(problem, found.simulator, 62, SearchBudget(), kept=kept)
        assert fit is not None and fit.problem.initial[kept, 1] == turned[kept, 1]
    free = placed(problem, found.simulator, 62, SearchBudget())
    assert free is not None and free.problem.initial[0, 1] != turned[0, 1]


def test_what_an_earlier_search_knows_of_the_places_is_where_all_begin(motor, search) -> None:
    """Seen: an arm's gravity, found with one experiment (100 %); placed anew beside a second one it explained 82 %, and crumbs joined."""
    model = augmented(search.problem, (attach(motor, "rotor", TorqueRipple(ORDER)),), search.surroundings)
    problem = problem_for(search.problem, model, {})
    simulator, position = Simulator.of(model, problem.free_names), model.states[1].name
    told = {name: {position: 0.1 * k} for k, name in enumerate(problem.records.names)}
    (begun,), (early,) = with_common_positions([problem], [problem], simulator, 62, [], SearchBudget(), True, told)
    for one in (begun, early):
        np.testing.assert_array_equal(one.initial[:, 1], [0.0, 0.1, 0.2])
        np.testing.assert_array_equal(one.initial[:, 0], problem.initial[:, 0])
    some = dict(list(told.items())[:2])
    ((anew,), _) = with_common_positions([problem], [], simulator, 62, [], SearchBudget(), True, some)
    assert not np.array_equal(anew.initial[:, 1], begun.initial[:, 1]), "where one is not known all are placed anew"


def test_where_every_position_is_shown_or_none_matters_nothing_changes(motor, search) -> None:
    bias = attach(motor, "rotor", ConstantBias())
    found = search.refitted((bias,), search.plain)
    problem = problem_for(search.problem, found.model, found.values())
    problems, early = with_common_positions([problem], [problem], found.simulator, 62, [], SearchBudget(), False)
    assert problems[0] is problem and early[0] is problem
