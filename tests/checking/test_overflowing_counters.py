"""A counter of several turns that overflows is told with its own number of counts, as are counts that stay around zero."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greybox_torch.api.data_warnings import data_warnings
from greybox_torch.checking.wrapped_channels import wrapped_channels
from greybox_torch.data import DataSet, Recording, load_dataset

TIME: np.ndarray = 0.001 * np.arange(4000)
ANGLE: np.ndarray = 300.0 * np.sin(2.0 * TIME)
REST = '[[experiment]]\nname = "run"\nfile = "run.csv"\nrole = "estimation"\n'


def card(folder: Path, entry: str, counts: np.ndarray) -> DataSet:
    (folder / "run.csv").write_text("\n".join(["enc,raw 16", *(f"{c:.0f},{c:.0f}" for c in counts.tolist())]))
    (folder / "dataset.toml").write_text(f"sample_time = 0.001\n[channels]\nq = {{ {entry} }}\n{REST}")
    return load_dataset(folder / "dataset.toml")


@pytest.mark.parametrize("lowest", [0, -32768])
@pytest.mark.parametrize(
    ("per_turn", "entry", "written"),
    [
        (4096, 'expr = "2*pi*enc/4096", unit = "rad"', "2*pi*unwrap(enc, 65536)/4096"),
        (2000, 'expr = "-pi*enc/1000", unit = "rad"', "-pi*unwrap(enc, 65536)/1000"),
        (2000, 'expr = \'radians(0.18*col("raw 16"))\', unit = "rad"', 'radians(0.18*unwrap(col("raw 16"), 65536))'),
        (4096, 'column = "enc", unit = "rad", scale = 0.00153398', "unwrap(enc, 65536)"),
    ],
)
def test_sixteen_bits(tmp_path: Path, per_turn: int, entry: str, written: str, lowest: int) -> None:
    """Seen: jumps of exactly a turn were told, those of a counter that overflows after 16 were not, and a diagnosis led astray."""
    counts = (np.floor(ANGLE / (2.0 * np.pi) * per_turn) - lowest) % 65536 + lowest
    told, *_ = [one for one in data_warnings(card(tmp_path, entry, counts), None) if "overflows" in one.found]
    assert "65536 counts of its column, within one sample" in told.found
    assert told.write.startswith(f"q = {{ expr = '{written}', … }}")
    whole, _, others = entry.partition(", ")
    mended = card(tmp_path, f"expr = '{written}', {others}", counts)
    assert whole and not [*wrapped_channels(mended)]
    turns = np.abs(mended.recordings[0].signals["q"])
    np.testing.assert_allclose(turns, np.abs(ANGLE[: len(turns)]), atol=1e-2)


def in_memory(values: np.ndarray, unit: str) -> list[str]:
    run = Recording.from_arrays("run", {"q": values}, sample_time=0.001, units={"q": unit})
    return [str(one) for one in wrapped_channels(DataSet([run], held_out_by_default=False))]


def test_an_angle_in_memory() -> None:
    (told,) = in_memory(np.mod(ANGLE, 32.0 * np.pi), "rad")
    assert (
        "nearly 100.531 rad within" in told
        and "write: the turns added up: numpy.unwrap(values, period=32 * pi)" in told
    )


def test_counts_around_zero() -> None:
    """Most of the range is never there: a motion of 200 counts to both sides."""
    (told,) = in_memory(np.floor(0.67 * ANGLE) % 65536, "")
    assert "jumps by nearly 65536 within one sample" in told


@pytest.mark.parametrize(
    "values",
    [
        np.where(np.sin(40.0 * TIME) > 0.0, 65535.0, 0.0) - 32768,  # a switch
        np.floor(32767 * np.clip(3.0 * np.sin(40.0 * TIME), -1.0, 1.0)),  # an amplifier at its limits
        np.random.default_rng(0).integers(0, 65536, 4000).astype(float),
        np.floor(32767 * np.sin(40.0 * TIME)),
    ],
)
def test_nothing_is_told(values: np.ndarray) -> None:
    assert in_memory(values, "V") == [] and in_memory(values, "") == []
