"""A file to resume from that is damaged is told as that, before anything is made of it. (Sound ones: `test_hybrid_training.py`.)"""

from __future__ import annotations

import json
import os
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from safetensors.numpy import save

from greybox_torch.errors import UserError
from greybox_torch.training.snapshot import SCHEMA, check_unknowns, load_snapshot

ABOUT = {"data": "x", "seed": 0}
PHYSICS: Any = SimpleNamespace(
    values=np.zeros(3), result=SimpleNamespace(problem=SimpleNamespace(values=np.zeros(3), initial=np.zeros((2, 1))))
)


def arrays() -> dict[str, Any]:
    long = {name: np.ones(4) for name in ("z", "best", "first", "second", "scale")}
    return {
        **long,
        "starts": np.zeros((5, 1)),
        "physics": np.zeros(3),
        "initial": np.zeros((2, 1)),
        "short": np.zeros(3),
    }


def content() -> dict[str, Any]:
    numbers = {"stage": 0, "epoch": 1, "best_loss": 0.5, "waited": 0, "steps": 3, "caution": 1.0}
    generator = np.random.default_rng(0).bit_generator.state
    return {"about": ABOUT, "numbers": numbers, "generator": generator, "history": [], "mean_square": 1.0}


def written(path: Path, held: dict[str, Any], said: dict[str, Any]) -> Path:
    path.write_bytes(save(held, {"schema": SCHEMA, "training": json.dumps(said)}))
    return path


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("z", np.array([1.0, np.nan, 1.0, 1.0]), "z is not of finite 64-bit numbers"),
        ("best", np.ones(4, dtype=np.float32), "best is not of finite 64-bit numbers"),
        ("first", np.ones(3), r"first has the shape \(3,\), expected \(4,\)"),
        ("second", np.array([np.inf] * 4), "second is not of finite"),
        ("scale", np.zeros(4), "a scale is not above zero"),
        ("starts", np.zeros(5), r"starts has the shape \(5,\)"),
        ("physics", np.zeros(2), r"physics has the shape \(2,\), expected \(3,\)"),
        ("initial", np.zeros((1, 1)), "initial has the shape"),
        ("short", None, "KeyError: 'short'"),
        ("z", None, "KeyError: 'z'"),
    ],
)
def test_arrays(tmp_path: Path, name: str, value: np.ndarray | None, message: str) -> None:
    held = arrays() | {name: value}
    path = written(tmp_path / "a.safetensors", {n: v for n, v in held.items() if v is not None}, content())
    with pytest.raises(UserError, match=rf"snapshot .*damaged \(.*{message}.*\); train anew instead of resuming"):
        load_snapshot(path, ABOUT, PHYSICS)


@pytest.mark.parametrize(
    "change",
    [
        {"numbers": {**content()["numbers"], "stage": -1}},
        {"numbers": {**content()["numbers"], "stage": 0.5}},
        {"numbers": {**content()["numbers"], "best_loss": float("nan")}},
        {"numbers": {**content()["numbers"], "caution": "much"}},
        {"numbers": {**content()["numbers"], "junk": 1}},
        {"numbers": []},
        {"generator": {}},
        {"generator": "PCG64"},
        {"history": [{"stage": 0}]},
        {"history": 3},
        {"mean_square": None},
        {"about": None},
    ],
)
def test_numbers(tmp_path: Path, change: dict[str, Any]) -> None:
    with pytest.raises(UserError, match=r"snapshot .*damaged"):
        load_snapshot(written(tmp_path / "a.safetensors", arrays(), content() | change), ABOUT, PHYSICS)


@pytest.mark.parametrize("junk", [b"", b"junk", b"\xff" * 100, b"\x08\0\0\0\0\0\0\0{}      "])
def test_junk(tmp_path: Path, junk: bytes) -> None:
    (tmp_path / "a.safetensors").write_bytes(junk)
    with pytest.raises(UserError, match="snapshot "):
        load_snapshot(tmp_path / "a.safetensors", ABOUT, PHYSICS)


def test_what_is_no_file(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for name, message in [("pipe", "is a pipe"), ("", "Is a directory"), ("nowhere", "no such file")]:
        with pytest.raises(UserError, match=f"snapshot .*{message}"):
            load_snapshot(tmp_path / name, ABOUT, PHYSICS)


def test_of_another_network(tmp_path: Path) -> None:
    snapshot: Any = SimpleNamespace(state=SimpleNamespace(z=np.zeros(4), starts=np.zeros((5, 1))))
    check_unknowns(tmp_path, snapshot, 4, 1)
    with pytest.raises(UserError, match="4 unknowns and 1 states, expected 5 and 1"):
        check_unknowns(tmp_path, snapshot, 5, 1)
