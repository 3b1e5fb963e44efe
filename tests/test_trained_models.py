"""The models in checkpoints/: they load, and do what their cards say."""

from __future__ import annotations

from pathlib import Path

import pytest

from greybox_torch import evaluate, load_checkpoint, load_dataset, load_saved_model
from greybox_torch.demo import DATASET

CHECKOUT = Path(__file__).parents[1]
FOLDER = CHECKOUT / "checkpoints"
ARM = CHECKOUT / "experiments" / "recordings" / "robot_arm_all_free.toml"
RECORDINGS = CHECKOUT.parent / "shared" / "recordings" / "robot_arm"
CARDS = {"demo": DATASET, "robot_arm": ARM}
EVERY = [(machine, name) for machine in CARDS for name in ("physics", "named", "hybrid")]


def test_only_these_files_and_little_of_them() -> None:
    files = {file.relative_to(FOLDER).as_posix(): file.stat().st_size for file in FOLDER.rglob("*") if file.is_file()}
    kept = {f"{machine}/{name}{half}" for machine, name in EVERY for half in (".json", ".safetensors")}
    beside = {f"{machine}/{file}" for machine in CARDS for file in ("verdict.json", "README.md")}
    assert set(files) == {"README.md", *kept, *beside}
    assert sum(files.values()) < 1_000_000


@pytest.mark.parametrize(("machine", "name"), EVERY)
def test_they_load_without_recordings(machine: str, name: str) -> None:
    saved = load_saved_model(FOLDER / machine / name)
    assert saved.checkpoint.model == "robot_arm"
    assert bool(saved.checkpoint.effects) == (name != "physics")
    assert set(saved.checkpoint.versions) == {"greybox_torch", "torch"}
    assert saved.checkpoint.values["J"] == pytest.approx(0.0329, rel=1e-2)
    speed = [-20.0, 20.0]
    rates = saved.rates({f"{body}_speed": speed for body in ("motor", "gearbox", "arm")})
    assert rates["motor_speed"][0] > 0 > rates["motor_speed"][1]  # friction slows down


@pytest.mark.parametrize(("machine", "name"), EVERY)
def test_they_reach_what_their_cards_say(machine: str, name: str) -> None:
    if machine == "robot_arm" and not RECORDINGS.is_dir():
        pytest.skip("the real recordings are not in ../shared beside the checkout")
    data, path = load_dataset(CARDS[machine]), FOLDER / machine / name
    checkpoint = load_checkpoint(path)
    assert checkpoint.dataset == data.sha256
    told = [figure.get("augmented") or figure["refit"] for figure in checkpoint.figures]
    for row, figure in zip(evaluate(data, path).scores, told, strict=True):
        # where parameters were estimated, `greybox fit` counts the start states that were estimated with them
        loose = 0.05 if name == "physics" and row["role"] == "estimation" else 0.005
        assert row["rmse"] == pytest.approx(figure["rmse"], rel=loose)
