"""Checkpoints that are damaged, cut short or made by hand: refused with what is wrong, never half read."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from safetensors.numpy import load_file, save, save_file

from greybox_torch.checkpoint import (
    Checkpoint,
    load_checkpoint,
    save_checkpoint,
)
from greybox_torch.checkpoint_card import CheckpointCard
from greybox_torch.errors import UserError
from tests.motor_checkpoint import MOTOR


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


def with_bytes(packed: bytes) -> Callable[[Path, Path], None]:
    """Other tensors, and a card that says so: the hash alone would not notice."""

    def edit(tensors: Path, card: Path) -> None:
        tensors.write_bytes(packed)
        card.write_text(json.dumps(json.loads(card.read_text()) | {"tensors": hashlib.sha256(packed).hexdigest()}))

    return edit


def packed_anew(change: Callable[[dict], object]) -> Callable[[Path, Path], None]:
    def edit(tensors: Path, card: Path) -> None:
        held = load_file(tensors)
        change(held)
        with_bytes(save({name: np.asarray(value) for name, value in held.items()}))(tensors, card)

    return edit


def tensors_of(kind: str, size: int) -> bytes:
    """A safetensors file with the motor's parameters as numbers of a kind that NumPy may not have."""
    entries = {
        n: {"dtype": kind, "shape": [], "data_offsets": [k * size, (k + 1) * size]} for k, n in enumerate(MOTOR.values)
    }
    header = json.dumps(entries).encode()
    return len(header).to_bytes(8, "little") + header + bytes(size * len(entries))


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
        (
            lambda tensors, card: (tensors.unlink(), card.unlink()),
            r"model: no such file or folder; expected a folder of",
        ),
        (
            lambda tensors, card: tensors.write_bytes(tensors.read_bytes()[:-3]),
            r"model.safetensors: damaged, or not the file .* SHA-256 is \w{12}…, expected \w{12}…",
        ),
        (other_tensors, "model.safetensors: damaged, or not the file that model.json was written with"),
        (lambda tensors, card: card.write_text(card.read_text()[:-30]), "model.json: not JSON"),
        (lambda tensors, card: card.write_bytes(b"\xff\xfe"), "model.json: not JSON"),
        (lambda tensors, card: card.write_text("[1]"), '"schema" is null, expected "greybox-checkpoint/1"'),
        (edited(lambda c: c.update(schema="greybox-checkpoint/2")), "a newer greybox_torch has written it: update"),
        (
            edited(lambda c: c.update(schema="greybox-fit/1")),
            '"schema" is "greybox-fit/1", expected "greybox-checkpoint/1"$',
        ),
        (edited(lambda c: c.pop("title")), '"title" is missing; expected'),
        (edited(lambda c: c.update(units=[])), r'"units" is \[\], expected an object'),
        (edited(lambda c: c["parameters"].append("J")), '"parameters" names J twice'),
        (edited(lambda c: c["parameters"].append("d")), '"units" lacks d; expected the unit of every parameter'),
        (edited(lambda c: c["units"].update(d="m")), '"units" has d; expected the names under "parameters" alone'),
        (edited(lambda c: c["units"].update(J=1)), '"units.J" is 1, expected a string'),
        (edited(lambda c: c["effects"].append("backlash")), '"effects.1" is "backlash", expected an object'),
        (edited(lambda c: c.update(free_starts="no")), '"free_starts" is "no", expected true or false'),
        (lambda tensors, card: card.write_text("[" * 100_000), "model.json: not JSON"),
        (lambda tensors, card: card.write_text('{"schema": ' + "1" * 5000 + "}"), "model.json: not JSON"),
        (
            packed_anew(lambda held: held.pop("J")),
            'model.safetensors: it lacks J; expected the tensors under "parameters" in model.json',
        ),
        (packed_anew(lambda held: held.update(d=np.float64(1.0))), "model.safetensors: it has d; expected"),
        (
            packed_anew(lambda held: held.update(J=np.zeros(2))),
            r"tensor J: found float64 of shape \[2\], expected one float64 number",
        ),
        (
            packed_anew(lambda held: held.update(J=np.float32(1.0))),
            r"tensor J: found float32 of shape \[\], expected one float64",
        ),
        (packed_anew(lambda held: held.update(J=np.float64("nan"))), "tensor J: found nan, expected a finite"),
        (packed_anew(lambda held: held.update(J=-np.float64("inf"))), "tensor J: found -inf, expected a fin"),
        (
            with_bytes(b"\x80\x04\x95 a pickle, whose content must never be looked at"),
            "not a safetensors file of 64-bit numbers",
        ),
        (with_bytes(b""), "not a safetensors file of 64-bit numbers"),
        (with_bytes(tensors_of("BF16", 2)), "model.safetensors"),
    ],
)
def test_what_can_be_wrong(tmp_path: Path, damage: Callable[[Path, Path], object], message: str) -> None:
    damage(*save_checkpoint(tmp_path / "model", MOTOR))
    with pytest.raises(UserError, match=message):
        load_checkpoint(tmp_path / "model")


@given(st.data())
def test_no_damage_to_the_tensors_passes(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    """Cut short, lengthened, or with any byte changed."""
    tensors, _ = save_checkpoint(tmp_path_factory.mktemp("checkpoints") / "model", MOTOR)
    whole = tensors.read_bytes()
    cut = st.integers(0, len(whole) - 1).map(lambda n: whole[:n])
    longer = st.binary(min_size=1, max_size=9).map(lambda more: whole + more)
    place, change = st.integers(0, len(whole) - 1), st.integers(1, 255)
    changed = st.tuples(place, change).map(
        lambda at: whole[: at[0]] + bytes([whole[at[0]] ^ at[1]]) + whole[at[0] + 1 :]
    )
    tensors.write_bytes(data.draw(cut | longer | changed))
    with pytest.raises(
        UserError, match=r"model.safetensors: damaged, or not the file that model.json was written with"
    ):
        load_checkpoint(tensors)


@given(st.data())
def test_a_card_cut_short_is_refused(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    _, card = save_checkpoint(tmp_path_factory.mktemp("checkpoints") / "model", MOTOR)
    whole = card.read_bytes().rstrip()
    card.write_bytes(whole[: data.draw(st.integers(0, len(whole) - 1))])
    with pytest.raises(UserError, match=r"model.json: not JSON"):
        load_checkpoint(card)


json_values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**53), 2**53)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=5,
)
json_objects = st.dictionaries(st.text(), json_values, max_size=3)


@given(
    st.builds(
        Checkpoint,
        model=st.text(),
        title=st.text(),
        values=st.just(MOTOR.values),
        units=st.fixed_dictionaries(dict.fromkeys(MOTOR.values, st.text())),
        effects=st.lists(json_objects, max_size=2),
        free_starts=st.booleans(),
        dataset=st.text(),
        figures=st.lists(json_objects, max_size=2),
    )
)
def test_the_card_comes_back_as_it_was(tmp_path_factory: pytest.TempPathFactory, checkpoint: Checkpoint) -> None:
    stem = tmp_path_factory.mktemp("checkpoints") / "model"
    save_checkpoint(stem, checkpoint)
    assert load_checkpoint(stem) == checkpoint


@given(key=st.sampled_from(sorted({*CheckpointCard.model_fields, "schema"})), value=json_values)
def test_any_card_is_read_or_refused(tmp_path_factory: pytest.TempPathFactory, key: str, value: object) -> None:
    """Whatever stands in a field, there is a checkpoint or a message, never another error."""
    _, card = save_checkpoint(tmp_path_factory.mktemp("checkpoints") / "model", MOTOR)
    card.write_text(json.dumps(json.loads(card.read_text()) | {key: value}))
    try:
        assert isinstance(load_checkpoint(card), Checkpoint)
    except UserError as error:
        assert str(error).startswith(f"checkpoint {card.with_suffix('')}")


@pytest.mark.parametrize("half", [".json", ".safetensors"])
def test_a_file_that_cannot_be_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, half: str) -> None:
    save_checkpoint(tmp_path / "model", MOTOR)
    system = os.open

    def refusing(path: Path, *how: int) -> int:
        if Path(path).suffix == half:
            raise PermissionError(13, "Permission denied")
        return system(path, *how)

    monkeypatch.setattr(os, "open", refusing)
    with pytest.raises(UserError, match=rf"model{half}: cannot be read: Permission denied"):
        load_checkpoint(tmp_path / "model")
