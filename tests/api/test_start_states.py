"""The fits that a model has with the start states of its own estimate, which a comparison from the first tenth is held against."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.api.start_states import begun_far, own_fits
from greybox_torch.checkpoint import load_checkpoint, save_checkpoint
from greybox_torch.estimate.far_starts import far_starts
from tests.api.motor import Motor


def test_fits_of_a_result_are_of_the_same_samples_wherever_they_are_from(folder: Path, data: gt.DataSet) -> None:
    """Seen: none of a fit whose data set had been read anew; fits of validation experiments, which begin on the first tenth."""
    fit = gt.fit(Motor(), data)
    own = {
        (row["experiment"], row["output"]): row["fit"]
        for row in fit.scores
        if row["model"] == "refit" and row["role"] == "estimation"
    }
    again = gt.DataSet(list(data.recordings), name="again")
    assert list(own) == [("Steps", "speed"), ("More steps", "speed")]
    assert own_fits(fit, data) == own_fits(fit, again) == own
    fit.save(folder / "fit")
    assert own_fits(folder / "fit", again) == own
    assert own_fits(fit, gt.DataSet(list(data.recordings[:2]))) == own_fits(Motor(), data) == {}


def test_of_a_training_there_are_none(folder: Path, data: gt.DataSet) -> None:
    """Seen: the fits of the law in the network's place beside a hybrid; both begin on the first tenth, as a comparison does."""
    options = {"net": "residual", "port": "actuator", "network": {"units": 2}}
    found = gt.train(Motor(), data, settings=gt.TrainingSettings(epochs=1), explain=False, **options)
    found.save(folder / "trained")
    assert own_fits(found, data) == own_fits(folder / "trained", data) == {}


def test_no_fit_where_the_estimate_itself_has_none(folder: Path, data: gt.DataSet) -> None:
    """Seen: that of the next model in the row."""
    place = {"experiment": "Steps", "role": "estimation", "output": "speed"}
    figures = [place | {"start": {"fit": 90.0, "rmse": 1.0}, "refit": {"fit": None, "rmse": None}}]
    fit = gt.fit(Motor(), data)
    fit.save(folder / "fit")
    held = load_checkpoint(folder / "fit")
    save_checkpoint(folder / "none", replace(held, figures=figures))
    assert own_fits(folder / "none", data) == {}


class Measured(Motor):
    """With a speed that begins as measured."""

    states = [gt.State("speed", "rad/s", initial="measured")]


def stuck(seconds: float, *, given: dict[str, dict[str, float]] | None = None) -> gt.DataSet:
    """A motor that dry friction holds for a while, and that then runs."""
    time = 0.01 * np.arange(1000)
    speed = np.clip(2.0 * (time - seconds), 0.0, None) + 0.01 * np.random.default_rng(0).standard_normal(1000)
    run = gt.Recording.from_arrays("run", {"voltage": np.full(1000, 5.0), "speed": speed}, sample_time=0.01)
    return gt.DataSet([run], initial=given or {}, held_out_by_default=False)


@pytest.mark.parametrize(("seconds", "given", "far"), [(3.0, None, True), (3.0, {"speed": {"value": -4.0}}, False)])
def test_a_free_run_that_begins_far_from_the_first_sample_is_told(
    seconds: float, given: dict[str, dict[str, float]] | None, far: bool
) -> None:
    """Seen: a free run from -60 rad/s, where 0 was measured, as the model lacks friction; its user looked for a wrong column."""
    data = stuck(seconds, given=given)
    run = gt.simulate(Measured(), data)
    found = [line for line in run.warnings if "run is begun with speed at -" in line]
    assert bool(found) is far, run.initial
    assert {f"start: {line}" for line in found} <= set(gt.compare(data, {"start": Measured()}).warnings)
    if far:
        assert "though the state is declared to begin as measured" in found[0]


@pytest.mark.parametrize(("off", "far"), [(0.03, False), (0.2, True)])
def test_a_start_a_little_off_is_told_by_a_fit_alone(off: float, far: bool) -> None:
    """With start values that are not the machine's, most free runs begin a little off."""
    data = stuck(3.0)
    model = Measured()
    run = gt.simulate(model, data).run
    measured = data.recordings[0].signals["speed"]
    begun = np.array([[measured[0] + off * np.ptp(measured)]])
    elsewhere = replace(run, comparison=replace(run.comparison, initial=begun))
    of_fit = far_starts(replace(run.problem, initial=begun))
    assert len(of_fit) == 1 and "run is begun with speed at" in of_fit[0]
    assert bool(begun_far({"start": elsewhere})) is far
