from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from safetensors.numpy import load_file, save_file

from greybox_torch.checkpoint import (
    Checkpoint,
    check_same_parameters,
    checkpoint_name,
    load_checkpoint,
    save_checkpoint,
)
from greybox_torch.errors import UserError

MOTOR = Checkpoint(
    model="/somewhere/my_motor.py:Motor",
    title="Motor",
    values={"J": 0.0123456789012345678, "k_1.2": -1e-300, "b": 0.0},
    units={"J": "kg m^2", "k_1.2": "N m/V", "b": ""},
    effects=[{"port": "rotor", "mechanism": "gravity", "parameters": {"level": 2.0}}],
    dataset="abc",
    figures=[{"experiment": "one", "refit": {"fit": 99.5, "rmse": 0.1}}],
)


@pytest.mark.parametrize("ending", ["", ".safetensors", ".json"])
@pytest.mark.parametrize("stem", ["model", "fit.v2", "deep/er/model"])
def test_comes_back_as_it_was(tmp_path: Path, stem: str, ending: str) -> None:
    tensors, card = save_checkpoint(tmp_path / (stem + ending), MOTOR)
    assert (tensors, card) == (tmp_path / f"{stem}.safetensors", tmp_path / f"{stem}.json")
    for path in (tmp_path / stem, tensors, card):
        assert load_checkpoint(path) == MOTOR
        assert checkpoint_name(path) == Path(stem).name
    assert sorted(p.name for p in tensors.parent.iterdir()) == [card.name, tensors.name]


@given(st.dictionaries(st.text("abcJ_.", min_size=1, max_size=6), st.floats(allow_nan=False, allow_infinity=False)))
def test_values_are_exact(tmp_path_factory: pytest.TempPathFactory, values: dict[str, float]) -> None:
    stem = tmp_path_factory.mktemp("checkpoints") / "model"
    save_checkpoint(stem, replace(MOTOR, values=values, units=dict.fromkeys(values, "m")))
    assert load_checkpoint(stem).values == values
    assert list(load_checkpoint(stem).values) == list(values)


def test_what_the_card_says(tmp_path: Path) -> None:
    tensors, card = save_checkpoint(tmp_path / "model", MOTOR)
    content = json.loads(card.read_text())
    assert content["schema"] == "greybox-checkpoint/1"
    assert content["parameters"] == ["J", "k_1.2", "b"]
    assert set(content["versions"]) == {"greybox_torch", "torch"}
    assert content["created"].startswith("20")
    held = load_file(tensors)
    assert {name: (value.shape, str(value.dtype)) for name, value in held.items()} == dict.fromkeys(
        content["parameters"], ((), "float64")
    )


def test_replaces_an_older_one(tmp_path: Path) -> None:
    save_checkpoint(tmp_path / "model", MOTOR)
    save_checkpoint(tmp_path / "model", replace(MOTOR, values={"J": 7.0}, units={"J": ""}))
    assert load_checkpoint(tmp_path / "model").values == {"J": 7.0}


def edited(change: Callable[[dict], object]) -> Callable[[Path, Path], None]:
    def edit(tensors: Path, card: Path) -> None:
        content = json.loads(card.read_text())
        change(content)
        card.write_text(json.dumps(content))

    return edit


def other_tensors(tensors: Path, card: Path) -> None:
    held = load_file(tensors)
    held["J"] += 1.0
    save_file(held, tensors)


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (
            lambda tensors, card: tensors.unlink(),
            r"model.safetensors: no such file \(its other half .*model.json is there\)",
        ),
        (
            lambda tensors, card: card.unlink(),
            r"model.json: no such file \(its other half .*model.safetensors is there\)",
        ),
        (lambda tensors, card: (tensors.unlink(), card.unlink()), r"no such file \(nor is its other half\)"),
        (
            lambda tensors, card: tensors.write_bytes(tensors.read_bytes()[:-3]),
            "model.safetensors: damaged, or not the file",
        ),
        (other_tensors, "model.safetensors: damaged, or not the file that model.json was written with"),
        (lambda tensors, card: card.write_text(card.read_text()[:-30]), "model.json: not JSON"),
        (lambda tensors, card: card.write_bytes(b"\xff\xfe"), "model.json: not JSON"),
        (lambda tensors, card: card.write_text("[1]"), 'schema is null, expected "greybox-checkpoint/1"'),
        (edited(lambda c: c.update(schema="greybox-checkpoint/2")), "a newer greybox_torch has written it: update"),
        (
            edited(lambda c: c.update(schema="greybox-fit/1")),
            'schema is "greybox-fit/1", expected "greybox-checkpoint/1"$',
        ),
        (edited(lambda c: c.pop("title")), '"title" is null, expected a str'),
        (edited(lambda c: c.update(units=[])), r'"units" is \[\], expected a dict'),
        (edited(lambda c: c["parameters"].append("d")), "model.safetensors: holds .*; model.json says J, k_1.2, b, d"),
    ],
)
def test_what_can_be_wrong(tmp_path: Path, damage: Callable[[Path, Path], object], message: str) -> None:
    damage(*save_checkpoint(tmp_path / "model", MOTOR))
    with pytest.raises(UserError, match=message):
        load_checkpoint(tmp_path / "model")


def test_parameters_of_another_model() -> None:
    path = Path("model.json")
    check_same_parameters(path, MOTOR, "Motor", ["b", "J", "k_1.2"])
    with pytest.raises(UserError, match=r"model Motor, which are not those of Arm: it lacks d; it has k_1.2, b"):
        check_same_parameters(path, MOTOR, "Arm", ["J", "d"])


def test_nowhere_to_write(tmp_path: Path) -> None:
    (tmp_path / "taken").touch()
    with pytest.raises(UserError, match="cannot be written"):
        save_checkpoint(tmp_path / "taken" / "model", MOTOR)
