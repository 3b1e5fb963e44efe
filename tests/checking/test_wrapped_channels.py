"""An encoder that begins anew after a turn is told with what to write; switches, steps and motion within a turn are not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greybox_torch.api.data_warnings import data_warnings
from greybox_torch.checking.wrapped_channels import wrapped_channels
from greybox_torch.data import DataSet, Recording, load_dataset

TIME: np.ndarray = 0.001 * np.arange(4000)
ANGLE: np.ndarray = 9.0 * np.sin(2.0 * TIME)
COUNTS: np.ndarray = np.floor(ANGLE / (2.0 * np.pi) * 16384) % 16384


def told(values: np.ndarray, unit: str) -> list[str]:
    run = Recording.from_arrays("run", {"q": values}, sample_time=0.001, units={"q": unit})
    return [str(one) for one in wrapped_channels(DataSet([run], held_out_by_default=False))]


@pytest.mark.parametrize(
    ("values", "unit", "turn"),
    [
        (COUNTS, "rad", "16384 rad"),  # as a first card has it where nothing says that these are counts
        (COUNTS, "", "16384 within"),
        (COUNTS * 360.0 / 16384, "deg", "360 deg"),
        (np.arctan2(np.sin(ANGLE), np.cos(ANGLE)), "rad", "6.28319 rad"),
    ],
)
def test_an_encoder_that_begins_anew(values: np.ndarray, unit: str, turn: str) -> None:
    gone = values.copy()
    gone[[100, 2000]] = np.nan
    for each in (values, gone):
        (one,) = told(each, unit)
        assert f"jumps by nearly {turn}" in one and " times, first 0." in one and "numpy.unwrap(values, period=" in one


@pytest.mark.parametrize(
    ("values", "unit"),
    [
        (ANGLE, "rad"),
        (np.where(np.sin(40.0 * TIME) > 0.0, 255.0, 0.0), "V"),  # a switch
        (np.where(np.sin(40.0 * TIME) > 0.0, 180.0, -180.0), "deg"),
        (np.round(127.5 + 127.5 * np.sin(40.0 * TIME)), ""),
        (np.random.default_rng(0).integers(0, 4096, 4000).astype(float), ""),  # noise of a converter
        (np.repeat(np.linspace(0.0, 360.0, 10), 400), "deg"),  # steps
        (np.mod(100.0 * TIME, 10.0), "V"),  # a sawtooth
        (np.mod(100.0 * TIME, 10.0), "rad"),
        (np.zeros(4000), "rad"),
    ],
)
def test_nothing_is_told(values: np.ndarray, unit: str) -> None:
    assert told(values, unit) == []


@pytest.mark.parametrize(
    ("entry", "written"),
    [
        (
            'column = "raw 14", unit = "rad", scale = 0.0003834951969714103',
            "expr = 'unwrap(col(\"raw 14\"), 16384)', …",
        ),
        ('column = "deg", unit = "rad", file_unit = "deg"', "expr = 'unwrap(deg, 360)', …"),
        ('column = "raw 14", unit = "rad"', "expr = 'unwrap(col(\"raw 14\"), 16384) * 2 * pi / 16384', …"),
        ('column = "deg", unit = "rad", scale = 1.0', "expr = 'unwrap(deg, 360) * 2 * pi / 360', …"),
        ('expr = "radians(deg)", unit = "rad"', "expr = 'unwrap(radians(deg), 2 * pi)', …"),
    ],
)
def test_what_to_write_mends_it(tmp_path: Path, entry: str, written: str) -> None:
    rows = "\n".join(f"{count:g},{count * 360 / 16384!r}" for count in COUNTS.tolist())
    (tmp_path / "run.csv").write_text(f"raw 14,deg\n{rows}\n")
    card, rest = tmp_path / "dataset.toml", '[[experiment]]\nname = "run"\nfile = "run.csv"\nrole = "estimation"\n'
    card.write_text(f"sample_time = 0.001\n[channels]\nq = {{ {entry} }}\n{rest}")
    found = [one for one in data_warnings(load_dataset(card), None) if "turn" in one.found]
    assert found and all(written in one.write for one in found)
    whole, _, others = entry.partition(", ")
    card.write_text(f"sample_time = 0.001\n[channels]\nq = {{ {written.removesuffix(', …')}, {others} }}\n{rest}")
    mended = load_dataset(card)
    assert whole and not [one for one in data_warnings(mended, None) if "turn" in one.found]
    first = mended.recordings[0].signals["q"]
    np.testing.assert_allclose(first - first[0], (ANGLE - ANGLE[0])[: len(first)], atol=1e-3)


def test_what_to_write_of_an_experiments_own_column(tmp_path: Path) -> None:
    """Seen: the line in [channels] was to be changed, which has no effect where an experiment has its own column."""
    (tmp_path / "run.csv").write_text("\n".join(["deg", *(f"{count * 360 / 16384!r}" for count in COUNTS.tolist())]))
    card, top = tmp_path / "dataset.toml", 'sample_time = 0.001\n[channels]\nq = { column = "q", unit = "rad" }\n'
    text = f'{top}[[experiment]]\nname = "run"\nfile = "run.csv"\n'
    card.write_text(f'{text}columns = {{ q = {{ column = "deg", file_unit = "deg" }} }}\n')
    found = [one for one in data_warnings(load_dataset(card), None) if "turn" in one.found]
    written = "columns = { q = { expr = 'unwrap(deg, 360)', … } }"
    assert found and all(one.write.startswith(f"{written} in that experiment") for one in found)
    card.write_text(text + written.replace("…", 'file_unit = "deg"') + "\n")
    mended = load_dataset(card)
    assert not [one for one in data_warnings(mended, None) if "turn" in one.found]
    first = mended.recordings[0].signals["q"]
    np.testing.assert_allclose(first - first[0], (ANGLE - ANGLE[0])[: len(first)], atol=1e-3)


UNWRAPPED = ["radians(unwrap(deg, 360))", "unwrap(radians(deg), 2 * pi)", "unwrap(deg, 360) * pi / 180"]


@pytest.mark.parametrize("entry", ['column = "deg", file_unit = "deg"', *(f'expr = "{text}"' for text in UNWRAPPED)])
def test_a_slower_file_that_is_joined_in_time(tmp_path: Path, entry: str) -> None:
    """Seen: a boat's heading, unwrapped on the card, with the advice to write unwrap(radians(unwrap(…)), 2 * pi), and so on without end."""
    degrees = np.degrees(ANGLE) % 360.0
    stamps, slow = TIME.tolist(), list(zip(TIME.tolist(), degrees.tolist(), strict=True))[::10]
    (tmp_path / "in.csv").write_text("\n".join(["t,u", *(f"{t:.3f},{k % 7}" for k, t in enumerate(stamps))]))
    (tmp_path / "slow.csv").write_text("\n".join(["t,deg", *(f"{t:.3f},{q:.6f}" for t, q in slow)]))
    channels = f'u = {{ column = "u", unit = "V" }}\nq = {{ {entry}, unit = "rad" }}\n'
    run = '[[experiment]]\nname = "run"\nfile = ["in.csv", "slow.csv"]\njoin = "time"\nrole = "estimation"\n'
    card = tmp_path / "dataset.toml"
    card.write_text(f'time = "t"\n[channels]\n{channels}{run}')
    data = load_dataset(card)
    told = {one.write for one in data_warnings(data, None) if "turn" in one.found}
    if "unwrap" in entry:
        found = data.recordings[0].signals["q"]
        moved = np.interp(TIME, TIME[::10], ANGLE[::10])[: len(found)]
        assert not told
        np.testing.assert_allclose(found - found[0], moved - moved[0], atol=1e-6)
    else:
        write = "q = { expr = 'unwrap(deg, 360)', … }, which adds up the turns, with the rest of the line as it is"
        assert told == {write}


def test_a_slower_column_of_the_first_file(tmp_path: Path) -> None:
    """Its expression comes before the straight lines between its samples: `unwrap` on the card is in time."""
    stamps = TIME.tolist()
    degrees = [f"{q:.6f}" if k % 10 == 0 else "" for k, q in enumerate((np.degrees(ANGLE) % 360.0).tolist())]
    rows = [f"{t:.3f},{q}" for t, q in zip(stamps, degrees, strict=True)]
    (tmp_path / "first.csv").write_text("\n".join(["t,deg", *rows]))
    (tmp_path / "other.csv").write_text("\n".join(["t,u", *(f"{t:.3f},{k % 7}" for k, t in enumerate(stamps))]))
    run = '[[experiment]]\nname = "run"\nfile = ["first.csv", "other.csv"]\njoin = "time"\nrole = "validation"\n'
    card = tmp_path / "dataset.toml"
    turns = {}
    for entry in ('column = "deg"', 'expr = "unwrap(deg, 360)"'):
        channels = f'u = {{ column = "u", unit = "V" }}\nq = {{ {entry}, unit = "deg" }}\n'
        card.write_text(f'time = "t"\n[channels]\n{channels}{run}')
        turns[entry] = [one for one in data_warnings(load_dataset(card), None) if "turn" in one.found]
    (before, after) = turns.values()
    assert "expr = 'unwrap(deg, 360)'" in before[0].write and not after
