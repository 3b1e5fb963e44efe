"""The ablation end to end on the documentation's motor, gone on with after an interruption, and what it says of bad input."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from experiments.ablation.__main__ import main
from experiments.ablation.ladder import MODELS
from experiments.ablation.networks import NetworkChoice, usual_networks
from experiments.ablation.page import figure_of, markdown, spread
from experiments.ablation.results import Case, Entry, load_case, read_case
from greybox_torch.checkpoint import Checkpoint, save_checkpoint
from greybox_torch.data import load_dataset
from greybox_torch.errors import UserError
from greybox_torch.estimate.surroundings import survey
from greybox_torch.mechanisms.actuator_deadzone import ActuatorDeadzone
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.stored import attachment_json
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.systems import RobotArm, load_model
from greybox_torch.training.physics import training_problem

OPTIONS = ("--quick", "--seeds", "2", "--networks", "residual:actuator:input")


@pytest.fixture
def folder(motor_folder: Callable[..., Path]) -> Path:
    """The motor with a dead zone, and beside it a diagnosis that says so, with a free curve besides."""
    folder = motor_folder(dead_zone=0.4)
    data, base = load_dataset(folder / "dataset.toml"), load_model(f"{folder / 'my_motor.py'}:Motor")
    problem = training_problem(data, base)
    around = survey(base, problem, Simulator.of(base))
    found = [attach(base, "actuator", ActuatorDeadzone()), attach(base, "rotor", Unknown("speed", 6))]
    values = {p.name: p.value for p in AugmentedModel(base, found, around).declared_parameters}
    effects = [attachment_json(a, around[a.port]) for a in found]
    checkpoint = Checkpoint(
        "my_motor.py:Motor", "Motor", values, dict.fromkeys(values, ""), effects=effects, dataset=data.sha256
    )
    save_checkpoint(folder / "diagnosis" / "model", checkpoint)
    (folder / "diagnosis" / "verdict.json").write_text(json.dumps({"sentence": "It has a dead zone.", "seconds": 9.0}))
    return folder


def run(folder: Path, *options: str) -> int:
    own = [str(folder / "dataset.toml"), "--out", str(folder / "out"), "--verdict", str(folder / "diagnosis")]
    return main([*own, *OPTIONS, *options])


def test_every_model_is_measured_and_nothing_twice(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(folder, "--models", "published", "physics", "hybrid") == 0
    first = read_case(folder / "out" / "motor" / "results.json")
    assert [(e.model, e.seed) for e in first.entries] == [
        ("published", None),
        ("physics", None),
        ("hybrid", 0),
        ("hybrid", 1),
    ]
    assert run(folder) == 0
    case = read_case(folder / "out" / "motor" / "results.json")
    assert case.entries[:4] == first.entries
    assert {e.model for e in case.entries} == set(MODELS)
    assert len(case.of("hybrid_named")) == len(case.of("black_box")) == 2
    validation = {name: case.of(name)[0].validation for name in MODELS}
    assert validation["named"] > validation["physics"] + 2.0 > validation["published"]
    assert validation["hybrid"] > validation["physics"] + 1.0
    assert validation["named"] > 98.0
    physics = case.of("physics")[0]
    assert all(v == 0.0 for v in physics.drift.values()) and set(physics.drift) == {"J", "b"}
    assert case.of("hybrid_named")[0].drift and not case.of("black_box")[0].drift
    assert case.notes["diagnosis"]["laws"] == ["actuator.actuator_deadzone"]
    assert case.notes["networks"][0]["share"] < 1.0

    page = (folder / "out" / "results.md").read_text()
    assert all(f"| {told} |" in page for told in MODELS.values())
    assert "the numbers mean nothing" in page and "It has a dead zone." in page
    assert (folder / "out" / "motor.png").stat().st_size > 10_000
    capsys.readouterr()


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (("--networks", "friction"), "--networks friction: expected KIND:PORT:SIGNAL"),
        (("--networks", "friction:rotary:speed"), "port: found 'rotary', model Motor has no such port"),
    ],
)
def test_networks_that_cannot_be(
    options: tuple[str, ...], expected: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(folder, "--models", "hybrid", *options) == 2
    assert expected in capsys.readouterr().err


def test_a_diagnosis_of_other_data(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    steps = folder / "steps.csv"
    steps.write_text("\n".join(steps.read_text().splitlines()[:-1]) + "\n")
    assert run(folder, "--models", "named") == 2
    assert "a diagnosis of other samples" in capsys.readouterr().err


def test_a_diagnosis_that_is_none(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "diagnosis" / "verdict.json").unlink()
    assert run(folder, "--models", "named") == 2
    assert "verdict.json" in capsys.readouterr().err


def test_usual_networks_of_the_arm() -> None:
    assert [str(n) for n in usual_networks(RobotArm())] == [
        "friction:motor:speed",
        "residual:motor:speed+load",
        "residual:gear_spring:deflection+rate",
        "residual:arm_spring:deflection+rate",
    ]
    assert NetworkChoice.parsed("residual:motor:speed+load").signals == ("speed", "load")


@pytest.fixture
def case() -> Case:
    entries = [
        Entry("physics", None, 88.0, 88.5, 2.0, 1.0, {"J": 0.0, "b": 0.0}),
        Entry("named", None, 90.0, 90.5, 3.0, 1.0, {"J": 0.5, "b": -60.0}),
        *(
            Entry("hybrid", s, 89.0 + s, fit, 4.0, float("nan"), {"J": 0.1, "b": 0.0})
            for s, fit in ((0, 88.9), (1, 88.7))
        ),
    ]
    return Case("bench", {"title": "Bench", "data": "abc", "machine": {"commit": "abc1234"}}, entries)


def test_the_page_says_what_was_wanted(case: Case) -> None:
    page = markdown([case])
    assert "| hybrid: physics + network | 2 | 89.50 ± 0.71 | 88.80 ± 0.14 | 5 %, J 10 % | 4 s |  |" in page
    assert "88.80 %; wanted at least 90.40 % (physics + named mechanisms -0.1): missed" in page
    assert "88.80 %; wanted at least 88.80 % (physics re-estimated +0.3): reached" in page
    assert "b × 61" in page and "| commit | abc1234 |" in page


def test_runs_that_overflow(case: Case, tmp_path: Path) -> None:
    case.entries.append(Entry("black_box", 0, float("-inf"), float("-inf"), 1.0, 1.0))
    case.save(tmp_path)
    again = read_case(tmp_path / "results.json")
    assert again.of("black_box")[0].validation == float("-inf")
    assert "1 of 1 overflow" in markdown([again])
    assert len(figure_of(again).axes[0].get_yticks()) == 3
    assert spread([1.0]) == "1.00"


def test_results_of_other_data(case: Case, tmp_path: Path) -> None:
    case.save(tmp_path)
    with pytest.raises(UserError, match='its data is "abc", and now it is "xyz"'):
        load_case(tmp_path, "bench", {**case.about, "data": "xyz"}, ("data",))
    (tmp_path / "results.json").write_text("{")
    with pytest.raises(UserError, match="damaged"):
        load_case(tmp_path, "bench", case.about, ("data",))
    assert load_case(tmp_path / "new", "bench", case.about, ("data",)).entries == []
