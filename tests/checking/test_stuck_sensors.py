"""A sensor that is stuck or clipped is told with its rows; what rests, is quantised, or is commanded so is not."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import greybox_torch as gt
from greybox_torch.api.data_warnings import data_warnings
from greybox_torch.data import DataSet, Recording, load_dataset
from greybox_torch.model import GreyBoxModel
from greybox_torch.systems.load import load_model

N = 2000
TIME: np.ndarray = 0.01 * np.arange(N)
NOISE: np.ndarray = np.random.default_rng(0).normal(0.0, 0.05, N)
WAVE: np.ndarray = 3.0 + 5.0 * np.sin(0.9 * TIME)
STEPS: np.ndarray = np.repeat([0.0, 2.0, 0.0, 1.0], N // 4)
STOPPED: np.ndarray = np.where(TIME % 7.0 < 2.0, np.nan, WAVE)
CARD = """sample_time = 0.01
[channels]
voltage = { column = "u", unit = "V" }
speed = { column = "n", unit = "rad/s", file_unit = "rpm" }
[[experiment]]
name = "run"
file = "run.csv"
"""


@pytest.fixture(scope="module")
def rotor(machines: Path) -> GreyBoxModel:
    return load_model(f"{machines / 'small.py'}:Rotor")


def told(model: GreyBoxModel | None, speed: np.ndarray, voltage: np.ndarray = STEPS) -> list[str]:
    run = Recording.from_arrays("run", {"voltage": voltage, "speed": speed}, sample_time=0.01)
    return [str(one) for one in data_warnings(DataSet([run], held_out_by_default=False), model)]


def held(values: np.ndarray, start: int, stop: int) -> np.ndarray:
    values = values.copy()
    values[start:stop] = values[start]
    return values


def deadband(values: np.ndarray, width: float) -> np.ndarray:
    """As a logger writes that holds what it has until it has changed by so much."""
    held = values.copy()
    for k in range(1, len(held)):
        held[k] = values[k] if abs(values[k] - held[k - 1]) > width else held[k - 1]
    return held


@pytest.mark.parametrize("decimals", [2, 15])
def test_a_stuck_sensor(rotor: GreyBoxModel, decimals: int) -> None:
    values = held(held(np.round(WAVE + NOISE, decimals), 700, 1000), 1500, 1530)
    (one,) = told(rotor, values)
    assert 'channel "speed": 300 samples are exactly ' in one
    assert "rows = [700, 1000], 7 to 9.99 s after the start (and 1 more such stretch); elsewhere noise" in one
    assert "two experiments in place of this one: rows = [0, 700] and rows = [1000, 2000]" in one


def test_a_stuck_measurement_of_an_input(rotor: GreyBoxModel) -> None:
    (one,) = told(rotor, WAVE, held(WAVE + NOISE, 700, 1000))
    assert 'channel "voltage": 300 samples are exactly ' in one
    assert "write: two experiments" in one  # a missing input takes its last value
    assert "missing =" not in one
    assert told(None, WAVE, held(WAVE + NOISE, 700, 1000)) == [one]


@pytest.mark.parametrize("noise", [NOISE, 20 * NOISE])  # long plateaus, and many short ones
def test_a_clipped_output(rotor: GreyBoxModel, noise: np.ndarray) -> None:
    (one,) = told(rotor, np.minimum(np.round(WAVE + noise, 3), 6.0))
    assert 'channel "speed": is exactly 6, ' in one
    assert "its largest value, for " in one
    (both,) = told(rotor, np.maximum(np.round(WAVE + noise, 3), -1.0))
    assert "its smallest value, for " in both
    assert "NaN in their place" in both


def test_what_to_write_on_the_card_is_in_the_files_unit_and_ends_the_warning(
    rotor: GreyBoxModel, tmp_path: Path
) -> None:
    speed = held(np.minimum(np.round(WAVE + NOISE, 3), 6.0), 1200, 1300)
    card = tmp_path / "dataset.toml"
    (tmp_path / "run.csv").write_text("u,n\n" + "".join(f"{u},{n}\n" for u, n in zip(STEPS, speed, strict=True)))
    card.write_text(CARD)
    stuck, clipped, _held_out = data_warnings(load_dataset(card), rotor)
    assert f"missing = {speed[1200]:.12g} in the channel's line" in stuck.write
    assert (
        "rows = [0, 1200] and rows = [1300, 2000]" in stuck.write
    )  # those of the whole, of which a quarter is held out
    assert clipped.write.startswith("missing = 6 in the channel's line on the card")
    card.write_text(CARD.replace('"rpm"', f'"rpm", missing = [6, {speed[1200]:.12g}]'))
    assert not [one for one in data_warnings(load_dataset(card), rotor) if "noise" in one.found]


RESTS = TIME % 7.0 < 2.0
FAST = np.round(np.cumsum(np.where(RESTS, 0.0, 10.37))) / 100.0
ABRUPT = np.cumsum(np.where(RESTS, 0.0, np.sin(3.0 * TIME) + np.cos(11.0 * TIME)))
FADING = 4.0 + np.where(RESTS, np.exp(-40.0 * (TIME % 7.0)), 1.0) * NOISE
ENCODER = np.round(np.cumsum(np.nan_to_num(STOPPED)) * 0.4) / 40.0
COUNTED = np.diff(np.round(np.cumsum(np.nan_to_num(STOPPED)) * 4.0), prepend=0.0)


@pytest.mark.parametrize(
    "values",
    [
        pytest.param(WAVE, id="exact"),
        pytest.param(np.where(TIME < 5.0, 2.0, 2.0 + np.sin(TIME - 5.0)), id="exact, at rest at first"),
        pytest.param(np.nan_to_num(STOPPED, nan=4.0) + NOISE, id="noise that goes on at rest"),
        pytest.param(ENCODER, id="encoder that stops"),
        pytest.param(COUNTED, id="speed of an encoder"),
        pytest.param(np.convolve(COUNTED, np.full(7, 1 / 7), "same"), id="the same behind a filter"),
        pytest.param(FAST, id="encoder that stops at once"),
        pytest.param(ABRUPT, id="exact, and stops at once"),
        pytest.param(np.round(FADING, 3), id="noise that fades where it comes to rest"),
        pytest.param(deadband(WAVE + 0.3 * NOISE, 0.04), id="recorded where it changes"),
        pytest.param(held(np.repeat((WAVE + NOISE)[::2], 2), 700, 730), id="changes with every second sample"),
        pytest.param(held(held(WAVE + NOISE, 700, 730), 900, 912), id="also held elsewhere"),
        pytest.param(np.clip(ENCODER, None, 0.6 * ENCODER.max()), id="encoder at an end stop"),
        pytest.param(np.round(WAVE + NOISE, 1), id="as coarse as its noise"),
        pytest.param(np.round(np.sin(TIME) + 0.01 * NOISE, 2), id="coarser than its noise"),
        pytest.param(np.minimum(WAVE, 6.0), id="exact and limited"),
        pytest.param(np.repeat((WAVE + NOISE)[::10], 10), id="held between slower samples"),
        pytest.param(np.where(TIME < 5.0, WAVE + NOISE, np.nan), id="missing"),
        pytest.param(STEPS, id="steps"),
    ],
)
def test_nothing_is_told_of_outputs(rotor: GreyBoxModel, values: np.ndarray) -> None:
    assert told(rotor, values) == told(None, values) == []


RANDOM = np.random.default_rng(1).normal(0.0, 3.0, N)


@pytest.mark.parametrize(
    "voltage",
    [
        pytest.param(np.clip(4.0 * (WAVE + NOISE), -10.0, 10.0), id="limited command under feedback"),
        pytest.param(np.where(TIME < 5.0, 2.0, 2.0 + RANDOM), id="random excitation around a value, paused"),
        pytest.param(np.where(TIME % 5.0 < 2.0, 0.0, WAVE + NOISE), id="off at times"),
        pytest.param(np.clip(RANDOM, -1.0, 1.0), id="limited random excitation"),
        pytest.param(RANDOM, id="random"),
    ],
)
def test_nothing_is_told_of_inputs(rotor: GreyBoxModel, voltage: np.ndarray) -> None:
    assert told(rotor, WAVE + NOISE, voltage) == told(None, WAVE + NOISE, voltage) == []


@given(
    seed=st.integers(0, 2**32 - 1),
    samples=st.integers(30, 3000),
    noise=st.sampled_from([0.0, 1e-6, 1e-3, 0.05, 1.0]),
    resolution=st.sampled_from([0.0, 1e-4, 1e-2, 0.1, 0.5]),
    correlated=st.sampled_from([0.0, 0.5, 0.95]),
    resting=st.sampled_from([0.0, 0.3, 0.9]),
    offset=st.sampled_from([0.0, 4.0]),
    differences=st.booleans(),
)
@settings(max_examples=300, deadline=None)
def test_nothing_is_told_of_channels_that_are_as_they_should_be(
    rotor: GreyBoxModel,
    seed: int,
    samples: int,
    noise: float,
    resolution: float,
    correlated: float,
    resting: float,
    offset: float,
    differences: bool,
) -> None:
    """Noise, white or not, on motion with stretches of rest, rounded to a resolution, or differences of what is: never told."""
    random = np.random.default_rng(seed)
    moving = np.repeat(random.random(samples // 100 + 1) >= resting, 100)[:samples]
    motion = np.cumsum(np.where(moving, 0.05 * np.cos(0.02 * np.arange(samples)), 0.0))
    draws = random.normal(0.0, noise, samples)
    for k in range(1, samples):
        draws[k] += correlated * draws[k - 1]
    values = motion + draws
    values = np.round(values / resolution) * resolution if resolution else values
    values = offset + (np.diff(values, prepend=values[0]) if differences else values)
    warnings = told(rotor, values, np.repeat([0.0, 1.0], (samples + 1) // 2)[:samples])
    assert not [one for one in warnings if "noise" in one]


def test_a_million_samples_take_little_time(rotor: GreyBoxModel) -> None:
    from greybox_torch.checking.clipped_outputs import clipped_outputs
    from greybox_torch.checking.stuck_sensors import stuck_sensors

    values = np.sin(1e-4 * np.arange(1_000_000)) + np.random.default_rng(0).normal(0.0, 0.01, 1_000_000)
    run = Recording.from_arrays(
        "run", {"voltage": values, "speed": held(np.minimum(values, 0.9), 10, 900)}, sample_time=1e-3
    )
    data, begin = DataSet([run], held_out_by_default=False), time.process_time()
    assert [*stuck_sensors(data, rotor), *clipped_outputs(data, rotor)]
    assert time.process_time() - begin < 3.0


def test_rows_are_told_of_the_file_alone(rotor: GreyBoxModel, tmp_path: Path) -> None:
    """On a card that leaves samples out a row is another one than of the file."""
    speed = held(WAVE + NOISE, 700, 1000)
    lines = (f"{t!r},{u!r},{n!r}" for t, u, n in zip(TIME.tolist(), STEPS.tolist(), speed.tolist(), strict=True))
    (tmp_path / "run.csv").write_text("\n".join(["t,u,n", *lines]))
    card = CARD.replace(', file_unit = "rpm"', "").replace("sample_time = 0.01", 'time = "t"')
    for more, rows in (("", True), ("resample = 0.02\n", False)):
        (tmp_path / "dataset.toml").write_text(more + card)
        (one,) = [str(w) for w in data_warnings(load_dataset(tmp_path / "dataset.toml"), rotor) if "stuck" in str(w)]
        assert ("rows = [" in one) is rows and "7 to 9.9" in one


def test_an_error_code_is_no_end_of_a_range(rotor: GreyBoxModel) -> None:
    (one,) = told(rotor, np.where(TIME % 7.0 < 2.0, -9999.0, WAVE + NOISE))
    assert "found -9999 before" in one


def test_inspect_tells_it(rotor: GreyBoxModel) -> None:
    run = Recording.from_arrays("run", {"voltage": STEPS, "speed": held(WAVE + NOISE, 700, 1000)}, sample_time=0.01)
    (one,) = gt.inspect(DataSet([run], held_out_by_default=False), rotor).warnings
    assert 'channel "speed": 300 samples are exactly' in one.found
