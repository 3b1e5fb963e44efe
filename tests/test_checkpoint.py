""""""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from safetensors.numpy import load_file

from greybox_torch.checkpoint import (
    check_same_parameters,
    check_same_units,
    checkpoint_name,
    load_checkpoint,
    save_checkpoint,
)
from greybox_torch.errors import NumericalError, UserError
from tests.motor_checkpoint import MOTOR


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


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_what_could_not_be_loaded_is_not_written(tmp_path: Path, value: float) -> None:
    with pytest.raises(NumericalError, match=r"model.safetensors: parameter J is (nan|inf), not a finite number"):
        save_checkpoint(tmp_path / "model", replace(MOTOR, values={**MOTOR.values, "J": value}))
    with pytest.raises(UserError, match=r"model.json: units: it lacks J"):
        save_checkpoint(tmp_path / "model", replace(MOTOR, units={"k_1.2": "", "b": ""}))
    assert not list(tmp_path.iterdir())


def test_units_of_another_model() -> None:
    path = Path("model.json")
    check_same_units(path, MOTOR, "Motor", {"J": "kg m^2", "b": ""})
    with pytest.raises(
        UserError, match=r'model.json, "units": J is in "kg m\^2", expected "g cm\^2" as model Motor has it'
    ):
        check_same_units(path, MOTOR, "Motor", {"b": "", "J": "g cm^2"})


def test_parameters_of_another_model() -> None:
    path = Path("model.json")
    check_same_parameters(path, MOTOR, "Motor", ["b", "J", "k_1.2"])
    with pytest.raises(UserError, match=r"model Motor, which are not those of Arm: it lacks d; it has k_1.2, b"):
        check_same_parameters(path, MOTOR, "Arm", ["J", "d"])


def test_nowhere_to_write(tmp_path: Path) -> None:
    (tmp_path / "taken").touch()
    with pytest.raises(UserError, match="cannot be written"):
        save_checkpoint(tmp_path / "taken" / "model", MOTOR)


def test_a_folder_of_results_stands_for_the_checkpoint_in_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Seen: `greybox compare dataset.toml found` said that found/model was there, and that it expected found.json."""
    save_checkpoint(tmp_path / "found" / "model", MOTOR)
    assert load_checkpoint(tmp_path / "found").values == MOTOR.values
    monkeypatch.chdir(tmp_path / "found")
    for path in (Path(), Path("../found")):
        assert load_checkpoint(path).values == MOTOR.values
        assert checkpoint_name(path) == "found"


def test_a_checkpoint_beside_a_folder_of_its_name_is_meant_itself(tmp_path: Path) -> None:
    save_checkpoint(tmp_path / "found" / "model", MOTOR)
    save_checkpoint(tmp_path / "found", replace(MOTOR, title="Itself"))
    assert load_checkpoint(tmp_path / "found").title == "Itself"


def test_a_folder_without_one_is_said_to_be_without(tmp_path: Path) -> None:
    (tmp_path / "found").mkdir()
    with pytest.raises(UserError, match=r"found: is a folder without results \(model\.json\); expected a folder"):
        load_checkpoint(tmp_path / "found")
    (tmp_path / "found" / "model.json").write_text("{}")
    with pytest.raises(UserError, match=r"model\.safetensors: no such file \(its other half .*model\.json is there"):
        load_checkpoint(tmp_path / "found")


def test_another_file_of_the_results_is_answered_with_their_folder(tmp_path: Path) -> None:
    """Seen: `greybox compare dataset.toml results/fit.json` missed a fit.safetensors, which there never was."""
    save_checkpoint(tmp_path / "found" / "model", MOTOR)
    (tmp_path / "found" / "fit.json").write_text("{}")
    with pytest.raises(UserError, match=r"fit\.json: is none, the folder .*found has results: name the folder;"):
        load_checkpoint(tmp_path / "found" / "fit.json")


def test_a_card_in_the_place_of_a_checkpoint_is_called_one(tmp_path: Path) -> None:
    """Seen: "dataset.toml.safetensors: no such file (nor is its other half)"."""
    (tmp_path / "dataset.toml").write_text("")
    with pytest.raises(UserError, match=r"dataset\.toml: is a data card, no checkpoint; expected a folder of results"):
        load_checkpoint(tmp_path / "dataset.toml")
