"""Cards damaged at random: each is a data set or one message, and nothing else."""

from __future__ import annotations

import os
import random
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from greybox_torch.data import load_dataset
from greybox_torch.errors import UserError
from tests.faults.conftest import CARD, CSV

VALUES = [
    "0", "-1", "1e400", "nan", "inf", "-inf", '""', '"u"', '"y"', "true", "[]", "{}", "[[]]", "9" * 400, "0xffff", "1_0", "2026-11-21",
    "'''", '"\\u0000"', '"\\ud800"', "{ column = 'u' }", "[0, 20]", "[20, 0]", '{ expr = "u + y" }', '{ expr = "u / 0" }', "'a.csv'",
    '["a.csv", "a.csv"]', '"concatenate"', '"time"', '{ column = "u", unit = "ms" }', '"rpm"', '"deg"', "3", "1e-300", "10", "07:00:00",
]  # fmt: skip
KEYS = [
    "sample_time", "time", "resample", "decimate", "hold", "name", "file", "join", "role", "rows", "columns", "value", "lower", "scale",
    "file_unit", "derivative", "expr", "column", "unit", "channels", "experiment", "model", "x", '""', '"a b"', "a.b",
]  # fmt: skip


@pytest.fixture(scope="module")
def folder() -> Iterator[Path]:
    memory = Path("/dev/shm")
    with tempfile.TemporaryDirectory(dir=memory if os.access(memory, os.W_OK) else None) as name:
        (Path(name) / "a.csv").write_text(CSV)
        yield Path(name)


def damaged(draw: random.Random) -> str:
    """The sound card with one to three keys, values, lines or characters of it changed."""
    lines = CARD.splitlines()
    for _ in range(draw.randint(1, 3)):
        k = draw.randrange(len(lines))
        key, equals, value = lines[k].partition(" = ")
        match draw.randrange(7):
            case 0 if equals:
                lines[k] = f"{key} = {draw.choice(VALUES)}"
            case 1 if equals:
                lines[k] = f"{draw.choice(KEYS)} = {value}"
            case 2:
                lines.insert(k, f"{draw.choice(KEYS)} = {draw.choice(VALUES)}")
            case 3:
                del lines[k]
                lines = lines or [""]
            case 4:
                lines.insert(k, draw.choice(lines))
            case 5 if "{" in lines[k]:
                lines[k] = lines[k].replace("}", f", {draw.choice(KEYS)} = {draw.choice(VALUES)} }}")
            case _:
                place = draw.randrange(len(lines[k]) + 1)
                lines[k] = (
                    lines[k][:place] + draw.choice("\"'[]{}=.,#\0\\é\n 0x-") + lines[k][place + draw.randrange(2) :]
                )
    return "\n".join(lines) + "\n"


@given(seed=st.integers(0, 2**32))
@settings(max_examples=250, suppress_health_check=list(HealthCheck))
def test_any_card_is_a_data_set_or_one_message(folder: Path, seed: int) -> None:
    """Twenty cards an example."""
    draw, card = random.Random(seed), folder / "dataset.toml"
    for _ in range(20):
        card.write_text(damaged(draw), encoding="utf-8")
        try:
            data = load_dataset(card)
        except UserError as error:
            assert str(error).startswith(str(folder))
            assert "\0" not in str(error)
            continue
        for recording in data.recordings:
            assert np.isfinite(recording.time).all()
            assert (np.diff(recording.time) > 0).all()
            assert len(recording) > 1
            for values in recording.signals.values():
                assert values.shape == recording.time.shape
                assert not np.isinf(values).any()
