"""Making the checkpoints: what is there is not done again, held-out stretches choose, and no diagnosis of other recordings is taken."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from experiments.make_checkpoints.__main__ import keep
from experiments.make_checkpoints.machines import CHECKOUT, MACHINES, Machine, Network
from experiments.make_checkpoints.steps import _command, made
from greybox_torch import load_checkpoint
from greybox_torch.errors import UserError

DEMO = MACHINES[0]
KEPT = CHECKOUT / "checkpoints"


def put(folder: Path, name: str, result: str, content: dict[str, Any], machine: str = "demo") -> None:
    """A step's folder, as the command would have left it."""
    folder.mkdir(parents=True)
    for half in (".json", ".safetensors"):
        shutil.copy(KEPT / machine / f"{name}{half}", folder / f"model{half}")
    (folder / result).write_text(json.dumps(content))


def training(held_out: float, fit: float) -> dict[str, Any]:
    choices = [{"penalty": None, "mse": 2.0}, {"penalty": 10.0, "mse": held_out}]
    scores = [{"role": "estimation", "augmented": {"fit": 1.0}}, {"role": "validation", "augmented": {"fit": fit}}]
    return {"statistics": {"held_out": choices, "penalty": 10.0}, "fit": scores, "seconds": 1.0}


@pytest.fixture
def work(tmp_path: Path) -> Path:
    """All steps of the demo done; the network that the validation experiments would prefer is not the one of the held-out stretches."""
    folder = tmp_path / "work"
    put(folder / "demo" / "physics", "physics", "fit.json", {})
    for network, (held_out, fit) in zip(DEMO.networks, ((1.5, 99.0), (0.01, 60.0)), strict=True):
        put(folder / "demo" / network.folder, "hybrid", "train.json", training(held_out, fit))
    put(folder / "demo" / "named", "named", "verdict.json", json.loads((KEPT / "demo" / "verdict.json").read_text()))
    (folder / "demo" / "named" / "commit.txt").write_text("abc1234\n")
    return folder


def test_models_verdict_and_page(work: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    result = made(DEMO, work, None)
    assert capsys.readouterr().out.count("is there already") == 4
    assert result.network == Network("residual", "gear_spring", "deflection")
    keep(DEMO, result, tmp_path / "out")
    for name in ("physics", "named", "hybrid"):
        assert load_checkpoint(tmp_path / "out" / name) == load_checkpoint(KEPT / "demo" / name)
    assert (tmp_path / "out" / "verdict.json").read_text() == (KEPT / "demo" / "verdict.json").read_text()
    page = (tmp_path / "out" / "README.md").read_text()
    assert "over deflection (kept) | 2 | 0.01 | 10 | 60.00 |" in page
    assert "`motor` over speed | 2 | 1.5 | 10 | 99.00 |" in page
    assert "| [named](named.json) | `greybox diagnose` | 14 |" in page
    assert "| abc1234 |" in page
    assert "| not recorded |" in page
    fits = next(line for line in page.splitlines() if line.startswith("| Around rest | validation |")).split("|")
    assert float(fits[8]) > 97.0  # of the named model


def test_diagnosis_that_is_handed_in(work: Path, tmp_path: Path, edit: Callable[[Path, str, str], None]) -> None:
    shutil.move(work / "demo" / "named", tmp_path / "given")
    assert made(DEMO, work, tmp_path / "given").named == tmp_path / "given"
    edit(tmp_path / "given" / "verdict.json", '"complete": true', '"complete": false')
    with pytest.raises(
        UserError, match=r'verdict.json: "complete" is not true; expected a diagnosis that ran to its end'
    ):
        made(DEMO, work, tmp_path / "given")
    put(tmp_path / "other", "named", "verdict.json", {"complete": True}, machine="robot_arm")
    with pytest.raises(UserError, match=r'model.json, "dataset": found \w{12}…, expected \w{12}…, the recordings of'):
        made(DEMO, work, tmp_path / "other")


def test_a_result_that_is_damaged(work: Path) -> None:
    (work / "demo" / DEMO.networks[0].folder / "train.json").write_text("{")
    with pytest.raises(UserError, match=r"train.json: cannot be read"):
        made(DEMO, work, None)


def test_a_step_is_run_once(
    motor_folder: Callable[..., Path], tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    machine = Machine("motor", motor_folder() / "dataset.toml", ())
    for _ in range(2):
        _command("fit", machine, tmp_path / "physics", "fit.json")
    out = capfd.readouterr().out
    assert out.count("motor: greybox fit") == out.count("is there already") == 1
    assert load_checkpoint(tmp_path / "physics" / "model").values["J"] == pytest.approx(0.02, rel=0.01)
    assert (tmp_path / "physics" / "commit.txt").read_text().strip()
    with pytest.raises(UserError, match=r"greybox fit of .*none.toml ended with exit code 2"):
        _command("fit", replace(machine, card=tmp_path / "none.toml"), tmp_path / "other", "fit.json")
