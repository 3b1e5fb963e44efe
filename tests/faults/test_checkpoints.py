"""Faults in checkpoints, and the answer."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from greybox_torch.checkpoint import Checkpoint, save_checkpoint

VALUES = {"J": 0.02, "k": 0.1, "b": 0.05}
UNITS = {"J": "kg m^2", "k": "N m/V", "b": "N m s/rad"}

Answer = Callable[..., str]

CARDS: list[tuple[Any, Any, str]] = [
    ("schema", "greybox-checkpoint/9", "a newer greybox_torch has written it"),
    ("schema", None, '"schema" is null'),
    ("model", 3, '"model" is 3, expected a string'),
    ("parameters", ["J", "J", "k", "b"], '"parameters" names J twice'),
    ("parameters", ["J", "k"], '"units" has b; expected the names under "parameters" alone'),
    ("units", {"J": "kg m^2"}, '"units" lacks k, b'),
    ("units", {**UNITS, "b": "N m min"}, 'b is in "N m min", expected "N m s/rad"'),
    ("effects", [{}], '"effects" are damaged'),
    ("effects", [{"port": "rotor", "mechanism": "magic"}], "checkpoint model"),
    ("effects", "none", '"effects" is "none", expected a list'),
    ("free_starts", 1, '"free_starts" is 1, expected true or false'),
    ("tensors", "0" * 64, "damaged, or not the file that model.json was written with"),
    ("title", "Engine", "not of Motor; expected a checkpoint of Motor, or Engine as the model that is named"),
]


@pytest.mark.parametrize(("field", "value", "message"), CARDS, ids=[f"{c[0]} {c[1]!s:.20}" for c in CARDS])
def test_card(spoilt: Path, answer: Answer, field: str, value: Any, message: str) -> None:
    card = spoilt / "model.json"
    card.write_text(json.dumps(json.loads(card.read_text()) | {field: value}))
    answer("compare", "dataset.toml", "model", message=message)


@pytest.mark.parametrize(
    "content",
    [b"", b"[]", b"{", b"\xff", b"null", b"[" * 10**5, b'{"schema": ' + b"9" * 5000 + b"}", b"{}"],
    ids=range(8),
)
def test_no_card(spoilt: Path, answer: Answer, content: bytes) -> None:
    (spoilt / "model.json").write_bytes(content)
    answer("compare", "dataset.toml", "model", message="checkpoint model.json: ")


@pytest.mark.parametrize("content", [b"", b"junk", b"\xff" * 100])
def test_no_tensors(spoilt: Path, answer: Answer, content: bytes) -> None:
    (spoilt / "model.safetensors").write_bytes(content)
    answer("compare", "dataset.toml", "model", message="checkpoint model.safetensors: damaged")


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("/", "not the name of a file"),
        ("..", "not the name of a file"),
        ("nowhere", "no such file"),
        ("model.txt", "no such file"),
        ("a\0b", "embedded null byte"),
        ("x" * 400, "checkpoint"),
        ("dataset.toml", "is a data card, no checkpoint"),
    ],
)
def test_name(answer: Answer, name: str, message: str) -> None:
    answer("compare", "dataset.toml", name, message=message)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"J": -0.02}, "J is -0.02, outside its bounds"),
        ({"k": -1.0}, "k is -1, outside its bounds"),
        ({"m": 1.0}, "it has m"),
    ],
)
def test_values(spoilt: Path, answer: Answer, values: dict[str, float], message: str) -> None:
    units = UNITS | dict.fromkeys(set(values) - set(UNITS), "")
    save_checkpoint(spoilt / "model", Checkpoint(f"{spoilt}/my_motor.py:Motor", "Motor", VALUES | values, units))
    answer("compare", "dataset.toml", "model", message=message)


@pytest.mark.parametrize("half", ["model.json", "model.safetensors"])
def test_what_is_no_file(spoilt: Path, answer: Answer, half: str) -> None:
    (spoilt / half).unlink()
    answer("compare", "dataset.toml", "model", message="no such file")
    (spoilt / half).mkdir()
    answer("compare", "dataset.toml", "model", message="checkpoint")
    (spoilt / half).rmdir()
    os.mkfifo(spoilt / half)
    answer("compare", "dataset.toml", "model", message="checkpoint")


@pytest.mark.parametrize("command", ["compare", "residuals"])
@pytest.mark.parametrize("place", ["evil.py", "sub/../evil.py"])
def test_a_model_file_that_only_the_checkpoint_names_never_runs(
    spoilt: Path, answer: Answer, command: str, place: str
) -> None:
    (spoilt / "sub").mkdir()
    (spoilt / "evil.py").write_text("from pathlib import Path\nPath(__file__).with_name('ran').touch()\n")
    save_checkpoint(spoilt / "model", Checkpoint(f"{spoilt}/{place}:Evil", "Evil", VALUES, UNITS))
    how = ["model"] if command == "compare" else ["--checkpoint", "model"]
    answer(command, "dataset.toml", *how, message="expected a checkpoint of Motor, or Evil as the model that is named")
    assert not (spoilt / "ran").exists()
