"""`diagnose` and what it leaves behind; the search itself is replaced, but for the demo, which runs it whole."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from greybox_torch.checkpoint import load_checkpoint
from greybox_torch.data import DataSet
from greybox_torch.diagnosis import pipeline
from greybox_torch.diagnosis.beliefs import NO_BELIEFS
from greybox_torch.diagnosis.effect import Curve, Effect
from greybox_torch.diagnosis.one_of import Alternative
from greybox_torch.diagnosis.progress import Progress
from greybox_torch.diagnosis.traces import Trace
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.estimate.comparison import Score
from greybox_torch.files import json_text
from greybox_torch.model import GreyBoxModel
from greybox_torch.report import page
from tests.commands.diagnosing import FILES, Make, diagnose, written

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
    size=0.98,
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
    return pipeline.Diagnosis(verdict, model, values, initial={}, attachments=[], rivals=())


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


def test_what_is_printed(motor_folder: Make, finding: Callable[..., dict[str, Any]]) -> None:
    finding(DEADZONE)
    folder = motor_folder()
    result = diagnose(folder)
    assert result.exit_code == 0
    lines = [" ".join(line.split()) for line in result.stdout.splitlines()]
    assert any(line.startswith("The mismatch is input dead zone at actuator") for line in lines)
    assert "actuator actuator_deadzone 0.91 98 half_width 0.4 0.01 V" in lines
    assert "slope 1 undetermined" in lines
    assert "input dead zone at actuator: |voltage| < 0.4 V" in lines
    rivals = "input dead zone at actuator: it could also be Coulomb friction at rotor (0.07); to tell them apart: slow reversals"
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


def test_the_report_for_print(motor_folder: Make, finding: Callable[..., dict[str, Any]]) -> None:
    finding(DEADZONE)
    folder = motor_folder()
    result = diagnose(folder, "--pdf")
    assert result.exit_code == 0 and "report.pdf" in result.stdout
    assert written(folder) == sorted([*FILES, "report.pdf"])
    assert (folder / "out" / "report.pdf").read_bytes().startswith(b"%PDF-1.")


def test_beliefs_of_the_card(motor_folder: Make, finding: Callable[..., dict[str, Any]]) -> None:
    called = finding(DEADZONE)
    folder = motor_folder()
    card = folder / "dataset.toml"
    plain = card.read_text()
    card.write_text(f'{plain}\n[beliefs]\n"rotor/*" = "unlikely"\n"actuator/input_gain" = 0.0\n')
    assert diagnose(folder).exit_code == 0
    assert called["beliefs"].given == {"rotor/*": 0.1, "actuator/input_gain": 0.0}
    card.write_text(f'{plain}\n[beliefs]\n"roter/*" = "unlikely"\n')
    refused = diagnose(folder)
    assert refused.exit_code == 2
    told = " ".join(refused.stderr.split())
    assert f'{card}: [beliefs]: "roter/*": model Motor has no port "roter" (did you mean "rotor"?)' in told


def test_what_is_written(motor_folder: Make, finding: Callable[..., dict[str, Any]]) -> None:
    called = finding(DEADZONE)
    folder = motor_folder()
    result = diagnose(folder, "--json", "--seed", "5", "--time-limit", "30")
    assert result.exit_code == 0
    assert called == {"seed": 5, "device": "cpu", "time_limit": 30.0, "beliefs": NO_BELIEFS}
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
    assert "input dead zone at actuator (probability 0.91)" in page
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


def test_strict_json(motor_folder: Make, finding: Callable[..., dict[str, Any]]) -> None:
    finding(DEADZONE)
    folder = motor_folder()
    text = diagnose(folder, "--json").stdout
    assert json_text(json.loads(text)) == text


def test_a_port_whose_signal_is_no_state_is_refused_at_the_beginning(
    motor_folder: Make, edit: Callable[..., None], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Seen: stopped in the search with "the model asks for the state 'sped'", without saying which port."""
    folder = motor_folder()
    edit(folder / "my_motor.py", 'speed="speed"', 'speed="sped"')
    monkeypatch.setattr(pipeline, "diagnose", lambda *_, **__: pytest.fail("searched"))
    result = diagnose(folder)
    assert result.exit_code == 2
    assert "my_motor.py, class Motor: port 'rotor': speed = \"sped\" is not a state (did you mean" in result.stderr
    assert written(folder) == []
