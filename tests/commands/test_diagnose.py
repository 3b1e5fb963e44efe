"""`diagnose` and what it leaves behind; the search itself is replaced, but for the demo, which runs it whole."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from greybox_torch.checkpoint import load_checkpoint
from greybox_torch.cli import app
from greybox_torch.data import DataSet
from greybox_torch.deadline import Deadline
from greybox_torch.diagnosis import pipeline
from greybox_torch.diagnosis.effect import Curve, Effect
from greybox_torch.diagnosis.one_of import Alternative
from greybox_torch.diagnosis.progress import Progress
from greybox_torch.diagnosis.verdict import Trace, Verdict
from greybox_torch.errors import NumericalError
from greybox_torch.estimate.comparison import Score
from greybox_torch.files import json_text
from greybox_torch.model import GreyBoxModel
from greybox_torch.report import page

Make = Callable[..., Path]
Edit = Callable[[Path, str, str], None]
FILES = ["hypotheses.json", "model.json", "model.safetensors", "report.html", "verdict.json"]

DEADZONE = Effect(
    port="actuator",
    mechanism="actuator_deadzone",
    probability=0.91,
    signals=("voltage",),
    where="|voltage| < 0.4 V",
    parameters={
        "half_width": {"value": 0.4, "std": 0.01, "unit": "V"},
        "slope": {"value": 1.0, "std": float("inf"), "unit": ""},
    },
    explained=0.98,
    alternatives=(Alternative("rotor", "coulomb_friction", 0.07),),
    curve=Curve("voltage", "V", np.linspace(-1, 1, 5), np.zeros(5), "V"),
    separating_experiment="slow reversals",
)


def made_up(data: DataSet, model: GreyBoxModel, seed: int, effects: tuple[Effect, ...]) -> Any:
    """A diagnosis with invented numbers, of the form that the real one has."""
    scores = {
        name: tuple(Score(r.name, r.role, "speed", fit, 1.0 - fit / 100.0) for r in data.recordings)
        for name, fit in (("start", 71.0), ("refit", 90.0), ("augmented", 99.5))
    }
    traces = []
    for r in data.recordings:
        y = r.signals["speed"]
        traces.append(Trace(r.name, r.role, "speed", "rad/s", r.time, y, 0.7 * y, 0.9 * y, 0.995 * y))
    verdict = Verdict(
        data.name, model.title, seed, 12.3, 0.99, effects, scores, ("Nothing explains more than chance.",), {}, (), tuple(traces)
    )  # fmt: skip
    values = {p.name: p.value for p in model.declared_parameters}
    return SimpleNamespace(verdict=verdict, model=model, values=values, initial={}, attachments=[], rivals=())


@pytest.fixture
def finding(monkeypatch: pytest.MonkeyPatch) -> Callable[..., dict[str, Any]]:
    """Makes the search find the given effects; returns the options that it will have been called with."""

    def find(*effects: Effect) -> dict[str, Any]:
        called: dict[str, Any] = {}

        def diagnose(
            data: DataSet, model: GreyBoxModel, *, on_progress: Callable[[Progress], None], **options: Any
        ) -> Any:
            aside = ("settings", "budget", "progress")
            called.update({name: value for name, value in options.items() if name not in aside})
            for seconds, leading in (
                (1.0, "perhaps [drag] at rotor"),
                (2.0, "perhaps [drag] at rotor"),
                (3.0, "drag at rotor"),
            ):
                on_progress(Progress(seconds, "screening every port", leading))
            return made_up(data, model, options["seed"], effects)

        monkeypatch.setattr(pipeline, "diagnose", diagnose)
        return called

    return find


def diagnose(folder: Path, *options: str) -> Result:
    return CliRunner().invoke(app, ["diagnose", str(folder / "dataset.toml"), "--out", str(folder / "out"), *options])


def written(folder: Path) -> list[str]:
    return sorted(path.name for path in (folder / "out").iterdir()) if (folder / "out").exists() else []


def test_what_is_printed(motor_folder: Make, finding: Callable[..., dict[str, Any]]) -> None:
    finding(DEADZONE)
    folder = motor_folder()
    result = diagnose(folder)
    assert result.exit_code == 0
    lines = [" ".join(line.split()) for line in result.stdout.splitlines()]
    assert any(line.startswith("The mismatch is actuator deadzone at actuator") for line in lines)
    assert "actuator actuator_deadzone 0.91 98 half_width 0.4 0.01 V" in lines
    assert "slope 1 undetermined" in lines
    assert "actuator_deadzone at actuator: |voltage| < 0.4 V" in lines
    rivals = "actuator_deadzone at actuator: it could also be coulomb_friction at rotor (0.07); to tell them apart: slow reversals"
    assert rivals in lines
    assert "Sweep validation speed 71 0.29 90 0.1 99.5 0.005 rad/s" in lines
    assert (
        f"Written to {folder / 'out'}: report.html, verdict.json, model.safetensors, model.json, hypotheses.json"
        in lines
    )
    told = [" ".join(line.split()) for line in result.stderr.splitlines()]
    assert told == ["0.0 s diagnosing Motor on the bench", "1.0 s perhaps [drag] at rotor", "3.0 s drag at rotor"]


def test_nothing_missing(motor_folder: Make, finding: Callable[..., dict[str, Any]]) -> None:
    finding()
    folder = motor_folder()
    result = diagnose(folder)
    assert result.exit_code == 0
    assert "Nothing is missing from Motor that these recordings can show" in result.stdout
    assert "- Nothing explains more than chance." in result.stdout
    verdict = json.loads((folder / "out" / "verdict.json").read_text())
    assert (verdict["mismatch"], verdict["effects"]) == (False, [])


def test_what_is_written(motor_folder: Make, finding: Callable[..., dict[str, Any]]) -> None:
    called = finding(DEADZONE)
    folder = motor_folder()
    result = diagnose(folder, "--json", "--seed", "5", "--time-limit", "30")
    assert result.exit_code == 0
    assert called == {"seed": 5, "device": "cpu", "time_limit": 30.0}
    assert written(folder) == FILES
    text = (folder / "out" / "verdict.json").read_text()
    assert result.stdout == text
    verdict = json.loads(text)
    contract = {"schema", "dataset", "model", "seed", "seconds", "mismatch", "confidence", "effects", "fit"}
    assert contract <= set(verdict)
    assert (verdict["schema"], verdict["seed"], verdict["mismatch"]) == ("greybox-verdict/2", 5, True)
    (effect,) = verdict["effects"]
    fields = {"port", "mechanism", "probability", "signals", "where", "parameters", "explained", "alternatives", "size"}
    assert set(effect) == fields
    assert effect["parameters"]["slope"] == {"value": 1.0, "std": None, "unit": ""}
    assert verdict["fit"][2] == {
        "experiment": "Sweep",
        "role": "validation",
        "output": "speed",
        "start": {"fit": 71.0, "rmse": pytest.approx(0.29)},
        "refit": {"fit": 90.0, "rmse": pytest.approx(0.1)},
        "augmented": {"fit": 99.5, "rmse": pytest.approx(0.005)},
    }
    saved = load_checkpoint(folder / "out" / "model")
    assert (saved.title, saved.figures) == ("Motor", verdict["fit"])
    page = (folder / "out" / "report.html").read_text()
    assert "actuator deadzone at actuator (probability 0.91)" in page
    assert f"greybox compare {folder}/dataset.toml {folder}/out/model" in page


def test_a_failing_page_leaves_nothing_behind(
    motor_folder: Make, finding: Callable[..., dict[str, Any]], monkeypatch: pytest.MonkeyPatch
) -> None:
    finding(DEADZONE)
    folder = motor_folder()
    monkeypatch.setattr(page, "render_page", lambda *_: 1 / 0)
    assert isinstance(diagnose(folder).exception, ZeroDivisionError)
    assert written(folder) == []


@pytest.mark.parametrize("blocked", FILES)
def test_all_files_or_none(motor_folder: Make, finding: Callable[..., dict[str, Any]], blocked: str) -> None:
    finding(DEADZONE)
    folder = motor_folder()
    (folder / "out" / blocked).mkdir(parents=True)
    result = diagnose(folder)
    assert result.exit_code == 2
    assert f"{blocked}: cannot be written: it is a folder" in result.stderr
    assert result.stdout == ""
    assert written(folder) == [blocked]


def test_numbers_that_fail(motor_folder: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: Any, **__: Any) -> None:
        raise NumericalError("the simulation overflows; try tighter bounds")

    monkeypatch.setattr(pipeline, "diagnose", fail)
    folder = motor_folder()
    result = diagnose(folder)
    assert result.exit_code == 3
    assert result.stderr.endswith("the numbers failed: the simulation overflows; try tighter bounds\n")
    assert (result.stdout, written(folder)) == ("", [])


def test_input_at_fault(motor_folder: Make, edit: Edit) -> None:
    folder = motor_folder()
    edit(folder / "dataset.toml", "speed = {", "sped = {")
    result = diagnose(folder)
    assert result.exit_code == 2
    assert "[channels] has no 'speed'" in result.stderr
    assert (result.stdout, written(folder)) == ("", [])


def test_nothing_to_estimate_from(motor_folder: Make) -> None:
    folder = motor_folder()
    card = folder / "dataset.toml"
    card.write_text(card.read_text().replace('"estimation"', '"validation"'))
    result = diagnose(folder)
    assert result.exit_code == 2
    assert 'no experiment has the role "estimation"' in result.stderr


@pytest.mark.parametrize("limit", ["0", "-3", "soon"])
def test_time_limits_that_are_none(motor_folder: Make, limit: str) -> None:
    assert diagnose(motor_folder(), "--time-limit", limit).exit_code == 2


def test_a_users_own_model(motor_folder: Make) -> None:
    """The real search, on the documentation's motor: the dead zone of 0.4 V that the model does not know."""
    folder = motor_folder(dead_zone=0.4)
    result = diagnose(folder, "--json")
    assert result.exit_code == 0, result.stderr
    (effect,) = json.loads(result.stdout)["effects"]
    assert (effect["port"], effect["mechanism"]) == ("actuator", "actuator_deadzone")
    assert effect["parameters"]["half_width"]["value"] == pytest.approx(0.4, rel=0.02)
    assert [name for name in written(folder) if name != "hypotheses"] == FILES


def test_seeds_change_no_verdict(motor_folder: Make) -> None:
    folder = motor_folder(dead_zone=0.4)
    verdicts = [json.loads(diagnose(folder, "--json", "--seed", str(seed)).stdout) for seed in (0, 1, 2)]
    assert [v["seed"] for v in verdicts] == [0, 1, 2]
    for key in ("mismatch", "effects", "fit", "confidence"):
        assert verdicts[0][key] == verdicts[1][key] == verdicts[2][key]


def test_stopped(motor_folder: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    """On a clock by which the time is up at once: how far a real one lets the search get depends on the machine."""
    monkeypatch.setattr(Deadline, "after", lambda seconds: Deadline(time.perf_counter() + 0.01))
    folder = motor_folder(dead_zone=0.4)
    verdict = json.loads(diagnose(folder, "--json", "--time-limit", "1").stdout)
    assert verdict["complete"] is False and verdict["effects"] == []
    assert verdict["mismatch"] is True and "times the noise" in verdict["sentence"]
    assert written(folder) == FILES


def test_stopped_where_nothing_is_missing(motor_folder: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Deadline, "after", lambda seconds: Deadline(time.perf_counter() + 0.01))
    verdict = json.loads(diagnose(motor_folder(), "--json", "--time-limit", "1").stdout)
    assert verdict["mismatch"] is False


def test_strict_json(motor_folder: Make, finding: Callable[..., dict[str, Any]]) -> None:
    finding(DEADZONE)
    folder = motor_folder()
    text = diagnose(folder, "--json").stdout
    assert json_text(json.loads(text)) == text


def test_without_a_compiler_it_says_so_at_once(motor_folder: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GREYBOX_COMPILER", "off")
    folder = motor_folder()
    result = diagnose(folder)
    assert result.exit_code == 2 and written(folder) == []
    assert (
        "a diagnosis needs a C++ compiler" in result.stderr and "pip install 'greybox_torch[compiler]'" in result.stderr
    )
