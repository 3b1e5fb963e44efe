"""The next recording of a machine under a controller: a motor with a load that tips over where nothing holds it."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import greybox_torch as gt
from greybox_torch.api.design import _aim
from greybox_torch.api.design_loops import loops_for
from greybox_torch.api.diagnosis_result import DiagnosisResult
from greybox_torch.api.hypotheses import hypotheses_of, hypothesis_files
from greybox_torch.checkpoint import checkpoint_files
from greybox_torch.cli import app
from greybox_torch.diagnosis.pipeline import Diagnosis
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.errors import UserError
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.simulators import simulator_for
from greybox_torch.estimate.surroundings import survey
from greybox_torch.experiment_design import search
from greybox_torch.experiment_design.aim import Trial
from greybox_torch.experiment_design.judged import _inputs, draws_of
from greybox_torch.experiment_design.simulated import keeps
from greybox_torch.files import write_all
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import CoulombFriction
from greybox_torch.mechanisms.stored import stored_effects
from greybox_torch.systems import load_model
from tests.design.conftest import rival
from tests.design.positioner import CARD, DAMPING, GAIN, INERTIA, LARGEST, LEVEL, LOOP, MODEL, SPAN, STEP, TIPPING, held


@pytest.fixture(scope="module")
def undecided(tmp_path_factory) -> DiagnosisResult:
    """A diagnosis by hand of recordings in one direction, which leaves dry friction and a constant torque."""
    folder = tmp_path_factory.mktemp("positioner")
    (folder / "positioner.py").write_text(MODEL)
    (folder / "dataset.toml").write_text(CARD)
    rng = np.random.default_rng(0)
    for name in ("up", "more"):
        voltage, angle = held(STEP * np.cumsum(np.repeat(rng.uniform(0.1, 0.6, 12), 25)))
        rows = np.column_stack([voltage, angle + rng.normal(0, 1e-3, len(angle))])
        np.savetxt(folder / f"{name}.csv", rows, delimiter=",", header="voltage,angle", comments="", fmt="%.12g")
    data = gt.load_dataset(folder / "dataset.toml")
    own, values = load_model(str(data.model)), {"J": INERTIA, "k": GAIN, "b": DAMPING, "m": TIPPING}
    own.set_values(values)
    problem = make_problem(data, own, data.estimation())
    around, starts = survey(own, problem, simulator_for(problem)), {"up": {"angle": 0.0, "speed": 0.0}}
    friction = rival(own, around, CoulombFriction(), 0.5, {**values, "F_c": LEVEL, "v_0": 0.02}, starts)
    torque = rival(own, around, ConstantBias(), 0.47, {**values, "bias": -LEVEL}, starts)
    verdict = Verdict("Positioner", "Motor", 0, 1.0, 0.97, (), {"start": (), "refit": (), "augmented": ()}, (), {}, ())
    effects = stored_effects(friction.model)
    found = Diagnosis(verdict, friction.model, dict(friction.values), starts, effects, (friction, torque))
    return DiagnosisResult(data, own, found)


@pytest.fixture(scope="module")
def designed(undecided) -> gt.DesignResult:
    with pytest.MonkeyPatch.context() as quicker:
        quicker.setattr(search, "DRAWN", 32)
        return gt.design(undecided)


def test_the_set_point_is_designed_within_its_limits(designed) -> None:
    (reference,) = designed.set_points.values()
    assert designed.follows == {"voltage": "angle"} and list(designed.set_points) == ["angle"]
    assert np.abs(reference).max() <= SPAN and np.abs(np.diff(reference)).max() <= 4.0 * STEP * (1 + 1e-6)
    for driven, outputs in zip(designed.driven, designed.outputs, strict=True):
        assert np.abs(driven["voltage"]).max() <= LARGEST and np.abs(outputs).max() <= SPAN
        assert np.abs(np.diff(driven["voltage"])).max() <= 400.0 * STEP * (1 + 1e-9)
    assert "as the set point of angle" in designed.sentence


def test_every_hypothesis_has_the_input_that_its_controller_makes(designed) -> None:
    """Of the same set point, friction and a constant torque make two different voltages; each is what the law answers to its angle."""
    reference = designed.set_points["angle"]
    for driven, outputs in zip(designed.driven, designed.outputs, strict=True):
        error, change = reference - outputs[:, 0], np.diff(outputs[:, 0], prepend=outputs[0, 0]) / STEP
        free = 20.0 * (error + np.concatenate([[0.0], np.cumsum(STEP * error)[:-1]]) - 0.1 * change)
        before = int(np.argmax(np.append(np.abs(free) > LARGEST, True)))  # until the first clipped sample
        np.testing.assert_allclose(driven["voltage"][:before], free[:before], atol=1e-6)
    first, other = (d["voltage"] for d in designed.driven)
    assert np.abs(first - other).max() > 0.05


def test_the_machine_does_what_is_predicted_and_decides(designed, undecided) -> None:
    """The independent machine on the set point keeps its limits, and its recording fits the law that acts alone."""
    voltage, angle = held(designed.set_points["angle"])
    assert np.abs(angle).max() <= 1.02 * SPAN
    assert np.sqrt(np.mean((angle - designed.outputs[0][:, 0]) ** 2)) < 0.02
    angle = angle + np.random.default_rng(1).normal(0, 1e-3, len(angle))
    new = gt.Recording.from_arrays("designed", {"voltage": voltage, "angle": angle}, sample_time=STEP)
    both = gt.DataSet([*undecided.data.recordings, new], hold="zoh")
    friction, torque = (gt.fit(kept, both).to_dict()["statistics"]["mse"] for kept in designed.hypotheses)
    assert friction < 0.5 * torque


def test_open_loop_the_limits_could_not_be_kept(designed, undecided) -> None:
    """Under draws of what is known of the parameters: the best set point keeps them under all, the best voltage leaves them under many."""
    opened = gt.design(undecided, controller={})
    assert opened.follows == {}
    assert left(opened, undecided, opened.inputs["voltage"], {}) > 5
    assert left(designed, undecided, designed.set_points["angle"], undecided.data.controller) == 0


def left(designed: gt.DesignResult, found: DiagnosisResult, commands: np.ndarray, entries) -> int:
    """Under how many draws of the parameters the limits are left."""
    loops = loops_for(entries, found.model.plain, designed.limits, STEP)
    draws = draws_of(_aim(hypotheses_of(found), None, loops), seed=0)
    inputs = _inputs(draws, Trial((), commands[None], 0.0), designed.time)
    values = [np.array([draw[h].problem.values for draw in draws]) for h in range(2)]
    kept = [keeps(draws[0][h], designed.limits, [u[h] for u in inputs], designed.time, values[h]) for h in range(2)]
    return int((~np.logical_and(*kept)).sum())


@pytest.fixture
def few(monkeypatch) -> None:
    """A search of few candidates, where only what is made of it counts."""
    monkeypatch.setattr(search, "DRAWN", 12)
    monkeypatch.setattr(search, "GENERATIONS", 1)


def test_command(undecided, few, tmp_path: Path) -> None:
    checkpoint, results = undecided._checkpoint(), tmp_path / "results"
    write_all({**checkpoint_files(results / "model", checkpoint), **hypothesis_files(results, undecided, checkpoint)})
    result = CliRunner().invoke(app, ["design", str(results), "--seconds", "0.3", "--json"])
    assert result.exit_code == 0, result.output
    told = json.loads(result.stdout)
    assert told["inputs"] == {} and told["set_points"]["angle"]["drives"] == "voltage"
    with (results / "design" / "design.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["time [s]", "angle_set_point [rad]", "voltage_expected [V]"] and len(rows) == 30
    assert (results / "design" / "design.png").stat().st_size > 10_000
    assert "[controller]" not in (results / "design" / "next.toml").read_text()


def test_it_is_told(designed, capsys) -> None:
    from rich.console import Console

    designed.show(Console(width=300))
    told = capsys.readouterr().out
    assert "Simulated under feedback: the controller drives voltage, so that angle follows its set point" in told


def test_precision_under_feedback(undecided, few) -> None:
    found = gt.design(undecided, precision="J", seconds=0.3)
    assert found.after is not None and found.before is not None and 0 < found.after < found.before and found.follows


@pytest.mark.parametrize(
    ("controller", "message"),
    [
        ({"volts": LOOP}, r'controller\], volts: no channel is named "volts" \(did you mean "voltage"'),
        ({"angle": {"measured": "voltage", "gain": 1.0}}, r"design, controller: angle: model Positioner has no such input"),
        ({"voltage": {"measured": "angle", "gain": "high"}}, r'design, controller, voltage: .*gain.* found "high", expected a number'),
    ],
)  # fmt: skip
def test_arguments_at_fault(undecided, controller, message) -> None:
    with pytest.raises(UserError, match=message):
        gt.design(undecided, controller=controller)


def test_a_controller_that_does_not_hold_the_machine(undecided, few) -> None:
    with pytest.raises(UserError, match="no set point of angle was found under which every hypothesis keeps"):
        gt.design(undecided, controller={"voltage": {"measured": "angle", "gain": -20.0}})
