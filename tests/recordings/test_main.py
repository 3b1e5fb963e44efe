"""The command from end to end on a small recording, its tables, and input that is at fault."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from experiments.recordings import __main__ as command
from experiments.recordings.__main__ import chosen
from experiments.recordings.cases import CASES, Case, Concealed, Reading
from experiments.recordings.table import row, table

MACHINES = Path(__file__).parents[1] / "machines"
CARD = """\
name = "Bench motor"
sample_time = 0.01
hold = "zoh"
[channels]
voltage = {{ column = "v", unit = "V" }}
speed = {{ column = "w", unit = "rad/s" }}
[[experiment]]
name = "Steps"
file = "steps.csv"
role = "estimation"
[[experiment]]
name = "More steps"
file = "more.csv"
role = "validation"
[model]
name = "{machine}:Motor"
[model.parameters]
b = {{ value = {b} }}
[diagnosis]
named_per_length = 2
curves_per_length = 0
finalists = 2
"""
DAMPING = Concealed(
    "viscous friction", "b", 0.03, "N m s/rad",
    (("rotor", "viscous_friction"),), (("rotor", "quadratic_drag"),), ("rotor",), (Reading("viscous_friction", "c"),),
)  # fmt: skip


@pytest.fixture
def motor(tmp_path: Path, motor_speed: Callable[..., np.ndarray], monkeypatch: pytest.MonkeyPatch) -> Case:
    """A motor whose friction is concealed by fixing it at zero, the only recording there is."""
    for seed, name in enumerate(("steps", "more")):
        rng = np.random.default_rng(seed)
        voltage = np.repeat(rng.uniform(-3.0, 3.0, 16), 10)
        speed = motor_speed(voltage, damping=0.03) + 0.02 * rng.standard_normal(len(voltage))
        np.savetxt(tmp_path / f"{name}.csv", np.stack([voltage, speed], 1), delimiter=",", header="v,w", comments="")
    machine = MACHINES / "motor.py"
    (tmp_path / "without.toml").write_text(CARD.format(machine=machine, b="0.0, fixed = true"))
    (tmp_path / "full.toml").write_text(CARD.format(machine=machine, b=0.05))
    case = Case(
        "motor without friction", "motor", str(tmp_path / "without.toml"), str(tmp_path / "full.toml"), "", (DAMPING,)
    )
    monkeypatch.setattr(Case, "recordings", property(lambda self: tmp_path))
    monkeypatch.setattr(command, "CASES", (case,))
    return case


def test_from_end_to_end_and_again(motor: Case, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    assert command.main([str(out), "--time-limit", "600"]) == 0
    results = json.loads((out / "results.json").read_text())["recordings"]
    (found,) = results
    assert found["named"] == 1
    (estimate,) = found["estimates"]
    assert estimate["found"]["value"] == pytest.approx(0.03, abs=0.003)
    assert estimate["shown"]
    assert found["fit"][1]["without"] < found["fit"][1]["found"]
    capsys.readouterr()
    verdict = out / "motor_without_friction" / "verdict.json"
    verdict.write_text(json.dumps({**json.loads(verdict.read_text()), "complete": False}))
    assert command.main([str(out)]) == 0  # from what is there
    assert "time limit" in capsys.readouterr().out


def test_recordings_that_are_not_there_are_skipped_and_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("experiments.recordings.cases.SHARED", tmp_path / "nowhere")
    assert command.main([str(tmp_path / "out")]) == 0
    said = capsys.readouterr().err
    assert said.count("skipped, ../shared/recordings/") == len(CASES)
    assert not (tmp_path / "out").exists()


def test_an_unknown_recording_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert command.main([str(tmp_path / "out"), "--only", "EMS"]) == 2
    assert 'no recording is called EMS (did you mean "EMPS"?)' in capsys.readouterr().err


def test_a_command_that_fails_is_said_and_the_exit_code_is_one(
    motor: Case, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path(motor.card).write_text(Path(motor.card).read_text().replace("[channels]", "[chanels]"))
    assert command.main([str(tmp_path / "out")]) == 1
    assert "chanels" in capsys.readouterr().err
    assert not (tmp_path / "out" / "results.md").exists()


def verdict(*effects: dict[str, Any]) -> dict[str, Any]:
    scores = {s: {"fit": 50.0, "rmse": 1.0} for s in ("start", "refit", "augmented")}
    fit = [{"experiment": "With pulses", "role": "validation", "output": "position", **scores}]
    return {"mismatch": bool(effects), "effects": list(effects), "fit": fit, "seconds": 9.0, "complete": True}


def effect(port: str, mechanism: str, **parameters: float) -> dict[str, Any]:
    values = {name: {"value": v, "std": 0.5, "unit": ""} for name, v in parameters.items()}
    return {"port": port, "mechanism": mechanism, "probability": 0.9, "parameters": values}


FIT = {
    "fit": [
        {"experiment": "With pulses", "role": "validation", "output": "position", "refit": {"fit": 93.0, "rmse": 0.1}}
    ],
    "parameters": {
        "F_c": {"value": 19.0, "std_sandwich": 1.5, "fixed": False},
        "offset": {"value": -0.1, "std_sandwich": 0.3, "fixed": False},
    },
}


def test_hits_near_ones_and_the_rest_are_told_apart_and_signs_turned() -> None:
    emps = next(case for case in CASES if case.name == "EMPS")
    said = verdict(
        effect("carriage", "stribeck_friction", F_c=21.0, c=3.0),
        effect("actuator", "input_bias", bias=3.0),
        effect("carriage", "position_dependent_friction"),
    )
    found = row(emps, said, FIT)
    assert (found["named"], found["detected"]) == (2, True)
    assert [f["mechanism"] for f in found["besides"]] == ["position_dependent_friction"]
    level, offset = found["estimates"]
    assert level["found"] == {"mechanism": "stribeck_friction", "value": 21.0, "std": 0.5}
    assert offset["found"] == {"mechanism": "input_bias", "value": -3.0, "std": 0.5}
    assert (level["shown"], offset["shown"]) == (True, False)
    assert found["brings"] == pytest.approx(0.99)  # of an error of 1 the published model leaves 0.1
    assert found["shown"] == {"effects": 1, "named": 1, "located": 1}
    text = table([found])
    assert (
        "- Effects left out: 2; named 2, rightly placed 2.\n- Of these the recordings show 1: named 1, rightly placed 1."
        in text
    )
    assert "| 2/2 (1 shown) |" in text
    assert "| EMPS | offset | N | -3.165 | -0.1 ± 0.3 | -3 ± 0.5 | input_bias |" in text


def test_what_improves_nothing_in_the_published_model_is_not_shown() -> None:
    """However many deviations from zero it is there."""
    alone = next(case for case in CASES if case.name == "EMPS without Coulomb friction")
    better, alike = (
        row(alone, verdict(), {**FIT, "fit": [{**FIT["fit"][0], "refit": {"fit": 50.0, "rmse": r}}]})
        for r in (0.9, 0.995)
    )
    assert better["estimates"][0]["shown"] and alike["estimates"][0]["shown"]
    assert better["shown"] == {"effects": 1, "named": 0, "located": 0}
    assert alike["shown"]["effects"] == 0
    assert "| 0/1 (0 shown) |" in table([{**alike, "fit": []}])


def test_a_finding_at_the_port_that_is_something_else_is_no_hit() -> None:
    arm = next(case for case in CASES if case.name == "arm without Coulomb friction")
    fit = {"fit": FIT["fit"], "parameters": {"F_c": {"value": 0.743, "std_sandwich": 0.0, "fixed": True}}}
    found = row(arm, verdict(effect("motor", "additional_mode")), fit)
    assert (found["named"], found["found"]) == (0, [])
    assert "| nothing | additional_mode at motor (0.90) | 0/1 |" in table([found])


def test_a_damper_is_read_from_a_law_that_saturates() -> None:
    arm = next(case for case in CASES if case.name == "arm without arm damping")
    fit = {"fit": FIT["fit"], "parameters": {"d_a": {"value": 0.003, "std_sandwich": None, "fixed": False}}}
    found = row(arm, verdict(effect("arm_spring", "nonlinear_damping", d_0=0.02, r_0=8.0)), fit)
    assert found["estimates"][0]["found"]["value"] == pytest.approx(0.0025)
    assert found["shown"]["effects"] == 1  # no deviation is known: what the published model removes decides


def test_names_with_commas_can_be_chosen() -> None:
    names = ["Silverbox, published model", "pendulum", "double pendulum, joint 1 without Coulomb friction"]
    assert [case.name for case in chosen(", ".join(names))] == names
    assert [case.name for case in chosen("Silverbox,EMPS")] == ["Silverbox", "EMPS"]
