"""An error value of the logger among normal samples is told with its place; steps, pulses and resting encoders are not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greybox_torch.api.data_warnings import data_warnings
from greybox_torch.checking.error_codes import is_error_code
from greybox_torch.checking.lone_samples import lone_samples
from greybox_torch.data import DataSet, Recording, load_dataset

TIME: np.ndarray = 0.01 * np.arange(400)
NOISE: np.ndarray = np.random.default_rng(0).normal(0.0, 0.01, 400)
STEPS: np.ndarray = np.repeat([0.0, 2.0, 0.0, 1.0], 100)
CARD = """sample_time = 0.01
[channels]
a = { column = "a", unit = "m", file_unit = "mm" }
[[experiment]]
name = "run"
file = "run.csv"
"""


def told(values: np.ndarray) -> list[str]:
    run = Recording.from_arrays("run", {"a": values}, sample_time=0.01)
    return [str(one) for one in lone_samples(DataSet([run], held_out_by_default=False), {})]


def changed(values: np.ndarray, at: list[int], value: float) -> np.ndarray:
    values = values.copy()
    values[at] = value
    return values


@pytest.mark.parametrize(
    "code", [-9999.0, 999.9, -999.25, 32767.0, 1e20, -1e23, 1e30, float(np.float32(1e30)), float(np.float32(9999.9))]
)
def test_numbers_that_are_error_codes(code: float) -> None:
    """Also in files of single precision."""
    assert is_error_code(code)


@pytest.mark.parametrize(
    "number", [0.0, 99.0, 9998.0, 1234.5, 1e19, 3e20, float(np.float32(9998.9)), float("inf"), 1e200]
)
def test_numbers_that_are_none(number: float) -> None:
    assert not is_error_code(number)


@pytest.mark.parametrize("values", [np.sin(TIME) + NOISE, STEPS, 20.0 + 60.0 * TIME])
def test_an_error_value(values: np.ndarray) -> None:
    (one,) = told(changed(values, [150], -9999.0))
    assert 'channel "a": sample 150 (the first is 0): found -9999 between' in one
    (both,) = told(changed(values, [120, 150], -9999.0))
    assert "(and 1 more such sample), as" in both


@pytest.mark.parametrize(("samples", "errors"), [(10, 1), (30, 1), (30, 2), (400, 1), (400, 12)])
def test_in_short_recordings_and_many_of_them(samples: int, errors: int) -> None:
    at = np.linspace(3, samples - 4, errors).astype(int).tolist()
    (one,) = told(changed((np.sin(TIME) + NOISE)[:samples], at, -9999.0))
    assert ("(and " in one) == (errors > 1)
    assert errors < 3 or f"(and {errors - 1} more such samples)" in one


@pytest.mark.parametrize("decimals", [3, 1])  # noise between the samples, or an encoder's counts
def test_an_error_value_within_a_few_ranges_of_a_smooth_channel(decimals: int) -> None:
    """Seen: 359.978 of a damaged frame in an angle that moves within 123 degrees, 2.4 ranges away, was not told."""
    angle = np.round(30.0 + 60.0 * np.sin(2.0 * TIME) + 0.1 * NOISE, decimals)
    assert told(angle) == []
    (one,) = told(changed(angle, [150], 359.978))
    assert "sample 150 (the first is 0): found 359.978 between" in one
    (both,) = told(changed(angle, [150, 260], 359.978))
    assert "(and 1 more such sample), as" in both


RPM: np.ndarray = np.round(1400.0 + 1350.0 * np.sin(2.0 * TIME) + 300.0 * NOISE, 1)


@pytest.mark.parametrize("value", [-9999.0, 9999.0, -9999.9, 32767.0, 1e30])
def test_an_error_code_within_a_few_ranges_by_its_value(value: float) -> None:
    """Seen: -9999 among speeds from -20 to 2740 rpm was not told, nor are several one after the other far from their neighbours."""
    assert told(RPM) == []
    for at in ([150], [150, 151, 152], [0], [399], [0, 1, 150]):
        (one,) = told(changed(RPM, at, value))
        assert f"sample {at[0]} (the first is 0): found {value:.6g} b" in one
    assert "found -9999 before " in told(changed(RPM, [0, 1], -9999.0))[0]
    assert "found -9999 behind " in told(changed(RPM, [398, 399], -9999.0))[0]


def test_an_error_code_is_one_of_the_file(tmp_path: Path) -> None:
    """In the channel's unit -9999 rpm are -1047 rad/s, and -9999 rad/s may be measured."""
    (tmp_path / "dataset.toml").write_text(CARD.replace('"m"', '"rad/s"').replace('"mm"', '"rpm"'))
    for value, count in ((-9999.0, 1), (-9999.0 * 60 / (2 * np.pi), 0)):
        values = changed(RPM if count else 8 * RPM, [150, 151], value)
        (tmp_path / "run.csv").write_text("a\n" + "".join(f"{one}\n" for one in values))
        warnings = [str(one) for one in lone_samples(load_dataset(tmp_path / "dataset.toml"), {})]
        assert len(warnings) == count
        assert not count or "found -9999 between " in warnings[0]
        assert not count or "missing = -9999 in the channel's line" in warnings[0]


@pytest.mark.parametrize(
    "values",
    [
        np.sin(TIME) + NOISE,
        np.repeat([0.0, 999.0, 300.0, 0.0], 100),  # commanded levels
        np.round(9000.0 + 999.0 * np.sin(TIME)),  # 9999 within what is measured
        changed(RPM, [150, 151], -8000.0),
        STEPS,
        changed(np.repeat([0.0, 2.0, -1.0, 1.0], 100) + 0.01 * NOISE, [150], 8.0),  # an input in steps with one pulse
        changed(NOISE, [150], 4.0),  # a blow to what rests
        changed(0 * TIME, [150], 1.0),  # an impulse
        changed(NOISE, [150, 151], 50.0),  # a spike of two samples
        changed(np.sin(TIME), [150], 3.0),
        changed(np.round(5.0 * TIME**2), [30], 1.0),  # an encoder that flickers
        np.random.default_rng(0).standard_t(2, 400),
    ],
)
def test_nothing_is_told(values: np.ndarray) -> None:
    assert told(values) == []


def test_the_line_of_the_file(tmp_path: Path) -> None:
    values = changed(1e3 * np.sin(TIME), [350], 65535e3)  # in the quarter that is held out
    (tmp_path / "run.csv").write_text("a\n" + "".join(f"{value}\n" for value in values))
    (tmp_path / "dataset.toml").write_text(CARD)
    (one,) = data_warnings(load_dataset(tmp_path / "dataset.toml"), None)
    assert '"run (held out)", channel "a": ' in one.found
    assert (
        f'{tmp_path / "run.csv"}, line 352, column "a", sample 350 (the first is 0): found 6.5535e+07 between'
        in one.found
    )
    assert one.write.startswith("an empty cell")


@pytest.mark.parametrize("change", ["no card", "no channel", "short", "no file"])
def test_files_that_were_replaced_meanwhile(tmp_path: Path, change: str) -> None:
    card, file = tmp_path / "dataset.toml", tmp_path / "run.csv"
    file.write_text("a\n" + "".join(f"{value}\n" for value in changed(np.sin(TIME), [150], -9999.0)))
    card.write_text(CARD)
    data = load_dataset(card)
    if change == "no card":
        card.write_text("[channels")
    elif change == "no channel":
        card.write_text(CARD.replace("a = {", "b = {"))
    elif change == "short":
        file.write_text("a\n" + "1.0\n" * 20)
    else:
        file.unlink()
    (one,) = lone_samples(data, {})
    assert one.place == "sample 150 (the first is 0)"
    assert one.value == pytest.approx(-9.999)
