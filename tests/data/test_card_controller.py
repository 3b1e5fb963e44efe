"""The card's section [controller]: what is read of it, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.errors import UserError
from greybox_torch.simulation.records import check_channels
from tests.machines.motor import Motor

PLAIN = """sample_time = 0.01
{top}
[channels]
voltage = {{ column = "u", unit = "V" }}
speed = {{ column = "w", unit = "rad/s" }}

[[experiment]]
name = "steps"
file = "steps.csv"

{section}
"""


def card(folder: Path, section: str, top: str = "") -> Path:
    rows = np.column_stack([np.ones(40), np.arange(40.0)])
    np.savetxt(folder / "steps.csv", rows, delimiter=",", header="u,w", comments="")
    (folder / "dataset.toml").write_text(PLAIN.format(section=section, top=top))
    return folder / "dataset.toml"


def loop(text: str, name: str = "voltage") -> str:
    return f"[controller]\n{name} = {{ {text} }}"


def test_what_is_read(tmp_path: Path) -> None:
    data = gt.load_dataset(card(tmp_path, loop('measured = "speed", gain = 2, integral = 10.0')))
    own = data.controller["voltage"]
    assert (own.measured, own.gain, own.integral, own.derivative, own.offset, own.delay) == (
        "speed",
        2.0,
        10.0,
        0,
        0,
        0,
    )
    check_channels(data, Motor())


def test_a_card_without_one_has_none(tmp_path: Path) -> None:
    assert gt.load_dataset(card(tmp_path, "")).controller == {}


@pytest.mark.parametrize(
    ("section", "message"),
    [
        ("controller = 3", "found 3, expected a table [controller]"),
        ("[controller]\nvoltage = 2.0", "[controller], voltage: found 2.0, expected a table"),
        (loop("gain = 2.0"), '[controller], voltage: "measured" is missing'),
        (loop('measured = "speed"'), '[controller], voltage: "gain" is missing'),
        (loop('measured = "speed", gain = "high"'), '[controller], voltage, gain: found "high", expected a number'),
        (loop('measured = "speed", gain = true'), "[controller], voltage, gain: found true, expected a number"),
        (loop('measured = "speed", gain = inf'), "[controller], voltage, gain: found Infinity, expected a finite number"),
        (loop('measured = "speed", gain = 0'), "[controller], voltage, gain: found 0, which follows nothing"),
        (loop('measured = "speed", gain = 1, integral = -1'), "voltage, integral: found -1, expected at least 0"),
        (loop('measured = "speed", gain = 1, derivative = -0.1'), "voltage, derivative: found -0.1, expected at least 0"),
        (loop('measured = "speed", gain = 1, derivative = nan'), "voltage, derivative: found NaN, expected"),
        (loop('measured = "speed", gain = 1, delay = -1'), "voltage, delay: found -1, expected at least 0"),
        (loop('measured = "speed", gain = 1, delay = 1.5'), "voltage, delay: found 1.5, expected a whole number"),
        (loop('measured = 1, gain = 1'), "voltage, measured: found 1, expected text in quotes"),
        (loop('measured = "speed", gian = 1'), 'unknown key "gian" (did you mean "gain"?)'),
        (loop('measured = "sped", gain = 1'), 'voltage, measured: no channel is named "sped" (did you mean "speed"?)'),
        (loop('measured = "speed", gain = 1', "volt"), 'volt: no channel is named "volt" (did you mean "voltage"?)'),
        (loop('measured = "voltage", gain = 1'), 'voltage, measured: found "voltage" itself, expected an output'),
    ],
)  # fmt: skip
def test_what_is_refused(tmp_path: Path, section: str, message: str) -> None:
    top, section = (section, "") if section.startswith("controller") else ("", section)
    file = card(tmp_path, section, top)
    with pytest.raises(UserError) as error:
        gt.load_dataset(file)
    assert message in str(error.value) and str(file) in str(error.value)


def test_a_hold_that_no_digital_loop_has(tmp_path: Path) -> None:
    file = card(tmp_path, loop('measured = "speed", gain = 1'), 'hold = "foh"')
    with pytest.raises(UserError, match=r'\[controller\]: a loop holds .* hold = "foh"; expected "zoh"'):
        gt.load_dataset(file)


def test_two_loops_of_one_output() -> None:
    signals = {"u": np.ones(40), "v": np.ones(40), "w": np.arange(40.0)}
    both = {"u": {"measured": "w", "gain": 1.0}, "v": {"measured": "w", "gain": 1.0}}
    with pytest.raises(
        UserError, match=r'\[controller\], v, measured: "w" is what u follows; expected an output of its own'
    ):
        gt.DataSet([gt.Recording.from_arrays("a", signals, sample_time=0.01)], controller=both)


@pytest.mark.parametrize(
    ("section", "message"),
    [
        (loop('measured = "voltage", gain = 1', "speed"), r"\[controller\] speed: model Motor has no such input; expected voltage"),
    ],
)  # fmt: skip
def test_what_the_model_does_not_have(tmp_path: Path, section: str, message: str) -> None:
    """Every command with a model says so, also those that make nothing of the section."""
    with pytest.raises(UserError, match=message):
        gt.simulate(Motor(), gt.load_dataset(card(tmp_path, section)))
