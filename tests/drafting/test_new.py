"""First model files: sound as they are, and good for a diagnosis."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import greybox_torch as gt
from greybox_torch.cli import app
from greybox_torch.drafting.pattern import PATTERNS

DRIVE = {"motor": 2.0, "pendulum": 1.0, "two_mass": 1.0, "tank": 4e-4, "thermal": 60.0}
STEP = {"motor": 0.01, "pendulum": 0.02, "two_mass": 0.005, "tank": 2.0, "thermal": 20.0}


def recording(model: gt.GreyBoxModel, like: str, name: str, role: str, seed: int) -> gt.Recording:
    """What the model itself gives with its declared values, started at rest, and a little noise."""
    draw = np.random.default_rng(seed)
    drive = np.repeat(draw.uniform(0.2, 1.0, 16), 20) * DRIVE[like]
    signals = {model.inputs[0].name: drive, **{o.name: np.full(320, 0.3) for o in model.outputs}}
    arrays = {"sample_time": STEP[like], "role": role}
    data = gt.DataSet([gt.Recording.from_arrays(name, signals, **arrays)], held_out_by_default=False)
    simulated = gt.simulate(model, data)[name]
    noisy = {
        o.name: simulated[o.name] + 1e-3 * np.std(simulated[o.name]) * draw.normal(size=320) for o in model.outputs
    }
    return gt.Recording.from_arrays(name, {**signals, **noisy}, **arrays)


@pytest.fixture
def made(tmp_path: Path, request: pytest.FixtureRequest) -> gt.GreyBoxModel:
    file = tmp_path / "machine.py"
    gt.new("machine", like=request.param, path=file).save()
    return gt.load_model(f"{file}:Machine")


@pytest.mark.parametrize("made", PATTERNS, indirect=True, ids=list(PATTERNS))
def test_a_pattern_is_sound_and_can_be_estimated(made: gt.GreyBoxModel, request: pytest.FixtureRequest) -> None:
    assert gt.check(made).findings == ()
    like = request.node.callspec.id
    data = gt.DataSet([recording(made, like, "steps", "estimation", 1), recording(made, like, "more", "validation", 2)])
    true = made.values()
    free = [p.name for p in made.declared_parameters if not p.fixed]
    made.set_values({name: 1.3 * true[name] for name in free})
    found = gt.fit(made, data)
    for name in free:
        assert found.parameters[name].value == pytest.approx(true[name], rel=0.05), name


@pytest.mark.parametrize("made", ["motor"], indirect=True)
def test_a_pattern_can_be_diagnosed(made: gt.GreyBoxModel) -> None:
    data = gt.DataSet(
        [recording(made, "motor", "steps", "estimation", 1), recording(made, "motor", "more", "validation", 2)]
    )
    assert not gt.diagnose(made, data).effects


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, ["new", "my_drive", "--like", "two_mass", "--json"])
    assert done.exit_code == 0, done.output
    told = {"schema": "greybox-new/1", "file": "my_drive.py", "class": "MyDrive", "like": "two_mass"}
    assert json.loads(done.stdout) == told
    assert CliRunner().invoke(app, ["check", "my_drive.py:MyDrive"]).exit_code == 0
    assert "greybox check my_drive.py:MyDrive" in (tmp_path / "my_drive.py").read_text()
    again = CliRunner().invoke(app, ["new", "my_drive"])
    assert again.exit_code == 2
    assert "is there already" in again.stderr


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["3d"], "error: NAME 3d: expected letters, digits, hyphens and underscores, beginning with a letter"),
        (["a/b"], "expected letters"),
        (["my press"], "NAME my press: expected letters"),
        (["class"], None),
        (["a", "--like", "motr"], '--like motr: expected one of motor, pendulum, two_mass, tank, thermal (did you mean "motor"?)'),
        (["a", "--out", "a.txt"], "--out a.txt: expected a file that ends in .py"),
    ],
)  # fmt: skip
def test_wrong_use(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], message: str | None) -> None:
    monkeypatch.chdir(tmp_path)
    done = CliRunner().invoke(app, ["new", *arguments])
    if message is None:  # the class is called Class
        assert done.exit_code == 0
        return
    assert done.exit_code == 2
    assert message in done.stderr
    assert not list(tmp_path.iterdir())


def test_from_python() -> None:
    made = gt.new("my_tank", like="tank")
    assert made.reference == "my_tank.py:MyTank"
    assert "class MyTank(GreyBoxModel)" in made.text
    assert "class MyTank(GreyBoxModel)" in made._repr_html_()
    assert len(made.plot().axes) == 1


@pytest.mark.parametrize("name", ["torch", "numpy", "json"])
def test_names_of_installed_modules(tmp_path: Path, name: str) -> None:
    """Seen: torch.py written, and every script in that folder ended in a circular import."""
    with pytest.raises(gt.UserError, match=f"is the name of an installed module, which {name}.py would hide"):
        gt.new(name, path=tmp_path / f"{name}.py")


def test_a_folder_of_that_name_is_no_installed_module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Seen: a folder motor/ of recordings in the current one, and no model could be called motor."""
    (tmp_path / "recorded_motor").mkdir()
    monkeypatch.syspath_prepend(tmp_path)
    assert gt.new("recorded_motor", path=tmp_path / "models" / "recorded_motor.py").name == "RecordedMotor"
