"""Machines in MuJoCo: their plain model is the one that the tool gets, and what is concealed shows."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

from experiments.concealed import generate
from experiments.concealed.engine import run as engine
from experiments.concealed.machines import ENGINE
from experiments.concealed.machines.engine import EngineMachine
from experiments.concealed.scaling import calibrate
from experiments.concealed.visibility import residuals, scatter, sensitivities, unexplained

pytest.importorskip("mujoco", reason="mujoco is not installed (extra [proof])")
EFFECTS = [(name, effect) for name, machine in ENGINE.items() for effect in machine.catalogue]


@pytest.fixture(autouse=True)
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(EngineMachine, "samples", 800)
    monkeypatch.setattr(EngineMachine, "pre_roll", 0.1)


@pytest.mark.parametrize("name", ENGINE)
def test_the_plain_equations_leave_no_more_than_an_encoders_noise(name: str) -> None:
    machine = ENGINE[name]
    trials = [machine.draw(3, 0, (), quiet=0.03)]
    runs = machine.run(trials, effects=False)
    left = residuals(machine, trials, runs)[0]
    columns = sensitivities(machine, trials, runs)[0]
    floor = scatter(unexplained(left, columns, len(machine.free), 1.0 / scatter(left)))
    assert np.all(floor < 5.0 * 0.03 * np.array(machine.sensor_noise))
    assert np.all(scatter(runs[0].outputs) > 1000.0 * floor)  # it moves


@pytest.mark.parametrize(("name", "effect"), EFFECTS)
def test_every_effect_shows_in_what_is_recorded(name: str, effect: str) -> None:
    machine = ENGINE[name]
    trial = machine.draw(5, 1, (effect,))
    trial.scales = [3.0]
    (plain,) = machine.run([trial], effects=False, fine=False)
    trial.draw_switches(plain)
    (run,) = machine.run([trial], fine=False)
    assert np.isfinite(run.outputs).all()
    moved = scatter(run.outputs - plain.outputs) / np.array(machine.sensor_noise)
    assert moved.max() > 20.0  # each output in units of its own noise


def still(frictionloss: float, torque: float) -> np.ndarray:
    """Positions of a joint without gravity under a constant torque [N m]; inertia 0.1 kg m^2."""
    machine = ENGINE["engine_two_link"]
    truth = machine.draw(1, 0, ()).truth
    xml = machine.description(truth, {"shoulder.frictionloss": frictionloss}, 2e-4)  # type: ignore[attr-defined]
    samples = 500
    feedback = engine.Feedback(
        np.tile([torque, 0.0], (samples, 1)), np.zeros((samples, 2)), (0, 1), np.zeros(2), np.zeros(2)
    )
    silent = engine.Sensing((0, 1), np.zeros((samples, 2)), np.zeros((samples, 2)), np.zeros(2))
    found = engine.run(xml, feedback, silent, disturbance=np.zeros(samples), start=np.zeros(2), sample_time=0.002)
    return found.outputs[:, 0]


def test_a_joint_sticks_below_its_dry_friction_and_moves_above() -> None:
    stuck, moving = still(1.0, 0.9), still(1.0, 1.5)
    assert np.abs(stuck).max() < 1e-3
    assert np.ptp(stuck[250:]) < 1e-4  # it does not creep
    assert moving[-1] > 0.05


def test_commands_act_late_by_the_delay() -> None:
    machine = ENGINE["engine_pendulum"]
    truth = machine.draw(1, 0, ()).truth
    xml = machine.description(truth, {}, 2e-4)  # type: ignore[attr-defined]
    samples = 200
    pulse = np.zeros((samples, 1))
    pulse[50:] = 1.0
    feedback = engine.Feedback(pulse, np.zeros((samples, 1)), (0,), np.zeros(1), np.zeros(1))
    silent = engine.Sensing((0,), np.zeros((samples, 1)), np.zeros((samples, 1)), np.zeros(1))
    shown = {
        delay: engine.run(
            xml, feedback, silent, disturbance=np.zeros(samples), start=np.zeros(1), sample_time=0.002, delay=delay
        ).outputs[:, 0]
        for delay in (0.0, 0.006, 0.007)
    }
    np.testing.assert_allclose(shown[0.006][3:], shown[0.0][:-3], atol=1e-9)
    middle = 0.5 * (shown[0.0][:-4] + shown[0.0][1:-3])  # three samples and a half
    assert np.abs(shown[0.007][4:] - middle).max() < 1e-4


def test_strengths_are_met_with_good_sensors_too() -> None:
    machine = ENGINE["engine_pendulum"]
    trials = [
        machine.draw(3, 0, ("pivot_dry",), targets=(12.0,)),
        machine.draw(3, 1, ("pivot_dry",), quiet=0.03, targets=(500.0,)),
    ]
    calibrate(machine, trials)
    assert trials[0].visibility == pytest.approx(12.0, rel=0.4)
    assert trials[1].visibility == pytest.approx(500.0, rel=0.4)
    assert trials[1].floor[0] < 0.1 * trials[0].floor[0]


def test_fresh_cases_have_cards_models_recordings_and_keys(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = [
        "--family",
        "mujoco",
        "--cases",
        "2",
        "--seed",
        "4",
        "--effects",
        "shoulder_dry,none",
        "--workers",
        "1",
    ]
    assert generate.main([str(tmp_path), *arguments]) == 0
    assert capsys.readouterr().out.splitlines()[0] == "c000 engine_two_link shoulder_dry moderate"
    card = tomllib.loads((tmp_path / "c000" / "dataset.toml").read_text())
    assert list(card["channels"]) == ["shoulder_torque", "elbow_torque", "shoulder_angle", "elbow_angle"]
    table = np.loadtxt(tmp_path / "c000" / "experiment1.csv", delimiter=",", skiprows=1)
    assert table.shape == (800, 4)
    keys = [json.loads((tmp_path / name / "key.json").read_text()) for name in ("c000", "c001")]
    assert [key["effects"] for key in keys] == [["shoulder_dry"], ["none"]]
    assert "class PlanarArm" in (tmp_path / "c000" / "model.py").read_text()


def test_an_effect_that_no_machine_of_the_family_has_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        generate.main([str(tmp_path), "--family", "mujoco", "--effects", "rust"])
    assert "no machine of mujoco has rust; there are none, cart_dry" in capsys.readouterr().err


def test_a_simulation_that_is_lost_is_not_a_number_and_leaves_no_log(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from experiments.concealed.engine.describe import document, inertial, joint, motors

    monkeypatch.chdir(tmp_path)
    wheel = joint("wheel", "hinge", "0 0 1", {}, damping=0.0) + inertial(1.0, "0 0 0", (1e-6,) * 3)
    xml = document(f"<body>{wheel}</body>", motors(("wheel",), {}), {}, step=5e-4)
    pushed = np.zeros((60, 1))
    pushed[20:] = 1e9
    feedback = engine.Feedback(pushed, np.zeros((60, 1)), (0,), np.zeros(1), np.zeros(1))
    silent = engine.Sensing((0,), np.zeros((60, 1)), np.zeros((60, 1)), np.zeros(1))
    found = engine.run(xml, feedback, silent, disturbance=np.zeros(60), start=np.zeros(1), sample_time=0.002)
    assert np.isfinite(found.outputs[:20]).all()
    assert np.isnan(found.outputs[-1]).all()  # MuJoCo starts anew from zero
    assert not list(tmp_path.iterdir())
