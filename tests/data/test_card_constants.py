"""Channels that have one value throughout an experiment: given by the card, or by a single number in memory."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import torch

import greybox_torch as gt
from greybox_torch.api.design_files import card_text
from greybox_torch.checking.constant_channels import constant_channels
from greybox_torch.checking.shared_columns import shared_columns
from greybox_torch.data import load_dataset
from greybox_torch.data.card import read_card
from greybox_torch.errors import UserError

Edit = Callable[[Path, str, str], None]
CHANNELS = 'speed = { column = "y", unit = "rad/s", scale = 2.0 }'
STEPS, SWEEP = 'role = "estimation"', 'role = "validation"'


@pytest.fixture
def crane(bench: Path, edit: Edit) -> Path:
    """The card of `bench` with a third channel, the rope, which no file has."""
    card = bench / "dataset.toml"
    edit(card, CHANNELS, f'{CHANNELS}\nrope = {{ unit = "m" }}')
    edit(card, STEPS, f"{STEPS}\nconstants = {{ rope = 0.9 }}")
    edit(card, SWEEP, f"{SWEEP}\nconstants = {{ rope = 1 }}")
    return card


def told(card: Path) -> str:
    with pytest.raises(UserError) as refused:
        load_dataset(card)
    return str(refused.value).removeprefix(f"{card}: ")


def test_a_constant_needs_no_column(crane: Path) -> None:
    steps, sweep = load_dataset(crane).recordings
    assert list(steps.signals) == ["voltage", "speed", "rope"]
    assert steps.signals["rope"].tolist() == [0.9] * 40 and sweep.signals["rope"].tolist() == [1.0] * 20
    assert steps.constants == {"rope"} and steps.part(0, 20).constants == {"rope"}
    assert not any("rope" in note for note in steps.notes)


def test_it_is_exact_whatever_is_done_to_samples(crane: Path, edit: Edit) -> None:
    edit(crane, 'unit = "V" }', 'unit = "V" }\nrope2 = { column = "u", unit = "m", file_unit = "mm" }')
    edit(crane, "constants = { rope = 0.9 }", "constants = { rope = 0.9, rope2 = 0.9 }")
    edit(crane, "constants = { rope = 1 }", "constants = { rope = 1, rope2 = 1.1 }")
    edit(crane, 'file_unit = "mm" }', "scale = 7.0, derivative = 10.0 }")
    assert '"scale" is of a column, and every experiment gives a constant' in told(crane)
    edit(crane, ", rope2 = 1.1 }", " }")
    edit(crane, 'voltage = "u_val"', 'voltage = "u_val", rope2 = "t"')
    edit(crane, "sample_time = 0.01", "sample_time = 0.01\ndecimate = 2")
    steps = load_dataset(crane).recordings[0]
    assert steps.signals["rope2"].tolist() == [0.9] * 20, "neither scaled, differentiated nor filtered"


def test_it_counts_beside_a_column_which_is_told(bench: Path, edit: Edit) -> None:
    card = bench / "dataset.toml"
    edit(card, STEPS, f"{STEPS}\nconstants = {{ voltage = 12.0 }}")
    steps, sweep = load_dataset(card).recordings
    assert set(steps.signals["voltage"]) == {12.0} and len(set(sweep.signals["voltage"])) == 20
    assert "voltage is 12 V throughout, as the card's constants say; its column is not read here" in steps.notes


@pytest.mark.parametrize(
    ("instead", "message"),
    [
        ("{ ropes = 0.9 }", '[[experiment]] "Steps", constants: no channel is named "ropes" (did you mean "rope"?)'),
        ("{ payload = 2.0 }", 'or a line of its own in [channels]: payload = { unit = "…" }'),
        ('{ rope = "0.9" }', '[[experiment]] 1 "Steps", constants, rope: found "0.9", expected a number'),
        ("{ rope = true }", '[[experiment]] 1 "Steps", constants, rope: found true, expected a number'),
        ("{ rope = inf }", "constants, rope: found Infinity, expected a finite number"),
        ("0.9", '[[experiment]] 1 "Steps", constants: found 0.9, expected a table'),
        ("{ rope = 1e200 }", "constants, rope: found 1e+200, expected a number of at most"),
        (
            '{ rope = 0.9, voltage = 1.0 }\ncolumns = { voltage = "u" }',
            '[[experiment]] "Steps", constants: "voltage" has a column of this experiment as well; expected one of them',
        ),
        ("{ rope = 1.0, voltage = 1.0, speed = 1.0 }", "no channel is left that has a column; expected one at least"),
        ("{ }", '[[experiment]] "Steps": channel "rope" has neither a column nor a constant; expected column = "…"'),
    ],
)
def test_constants_that_are_none(crane: Path, edit: Edit, instead: str, message: str) -> None:
    edit(crane, "{ rope = 0.9 }", instead)
    assert message in told(crane)


def test_both_ways_are_named(crane: Path, edit: Edit) -> None:
    edit(crane, "constants = { rope = 0.9 }", "")
    assert told(crane).endswith('or here columns = { rope = "…" } or constants = { rope = … }')
    edit(crane, "constants = { rope = 1 }", "")
    assert told(crane).endswith("or constants = { rope = … } in every [[experiment]] where it has one value throughout")


@pytest.mark.parametrize("entry", ["0.9", "{ constant = 0.9 }", "{ value = 0.9, unit = 'm' }"])
def test_other_places_where_it_is_looked_for(crane: Path, edit: Edit, entry: str) -> None:
    edit(crane, 'rope = { unit = "m" }', f"rope = {entry}")
    assert "constants = { rope = 0.9 } in every [[experiment]]" in told(crane)


def test_a_whole_number_beyond_any_float_is_answered(crane: Path, edit: Edit) -> None:
    """Seen, by random cards: OverflowError."""
    edit(crane, 'rope = { unit = "m" }', f"rope = {{ value = {'9' * 400} }}")
    assert "constants = { rope = 999" in told(crane)


def test_an_expression_of_no_column(crane: Path, edit: Edit) -> None:
    edit(crane, 'rope = { unit = "m" }', 'rope = { expr = "0.9" }')
    assert "no expr and constants = { NAME = … } in every [[experiment]]" in told(crane)


def test_a_unit_of_a_file_that_is_not_there(crane: Path, edit: Edit) -> None:
    edit(crane, 'rope = { unit = "m" }', 'rope = { unit = "m", file_unit = "mm" }')
    assert told(crane).endswith('expected no file_unit, and constants in the channel\'s unit, which is "m"')


def test_what_is_meant_to_be_constant_is_no_warning(crane: Path, edit: Edit) -> None:
    edit(crane, "constants = { rope = 1 }", "constants = { rope = 0.9 }")
    edit(crane, 'rope = { unit = "m" }', 'rope = { unit = "m" }\nroom = { unit = "degC" }')
    edit(crane, "constants = { rope = 0.9 }\ncol", "constants = { rope = 0.9, room = 20 }\ncol")
    edit(crane, "constants = { rope = 0.9 }\n\n", "constants = { rope = 0.9, room = 20 }\n\n")
    data = load_dataset(crane)
    assert list(constant_channels(data, None)) == [] and list(shared_columns(data)) == []


def test_a_single_number_in_memory() -> None:
    moving = np.arange(20.0)
    for number in (0.9, np.float32(0.9), np.array(0.9), torch.tensor(0.9, requires_grad=True)):
        made = gt.Recording.from_arrays("a", {"rope": number, "force": moving}, sample_time=0.01)
        assert made.signals["rope"] == pytest.approx(np.full(20, 0.9), rel=1e-7) and made.constants == {"rope"}
        assert list(made.signals) == ["rope", "force"]
    frame = {"t": moving, "F": moving}
    made = gt.Recording.from_dataframe(
        "a", frame, time="t", columns={"force": "F"}, constants={"rope": 1}, units={"rope": "m"}
    )
    assert set(made.signals["rope"]) == {1.0} and made.units == {"rope": "m"}


@pytest.mark.parametrize(
    ("signals", "message"),
    [
        ({"force": 1.0}, "found one number for every channel, expected an array of one at least"),
        ({"force": [1.0] * 20, "rope": float("nan")}, 'channel "rope": found nan, expected a number'),
        ({"force": [1.0] * 20, "rope": 10**400}, 'channel "rope": found inf, expected a finite number'),
        ({"force": [1.0] * 20, "rope": True}, 'channel "rope": has the shape ()'),
        ({"force": [1.0] * 20, "rope": "0.9"}, 'channel "rope": holds text'),
    ],
)
def test_single_numbers_that_are_none(signals: dict, message: str) -> None:
    with pytest.raises(UserError, match='recording "a"') as refused:
        gt.Recording.from_arrays("a", signals, sample_time=0.01)
    assert message in str(refused.value)


@pytest.mark.parametrize(
    ("constants", "message"),
    [({"F": 1.0}, 'constants: "F" has a column as well'), ({"rope": "1"}, "constants: found '1' for \"rope\"")],
)
def test_constants_beside_a_table_that_are_none(constants: dict, message: str) -> None:
    with pytest.raises(UserError) as refused:
        gt.Recording.from_dataframe("a", {"F": np.arange(20.0)}, sample_time=0.1, constants=constants)
    assert message in str(refused.value)


def test_a_recording_without_it_is_told_of_the_other_way() -> None:
    a = gt.Recording.from_arrays("a", {"force": np.arange(20.0), "rope": 0.9}, sample_time=0.01)
    b = gt.Recording.from_arrays("b", {"force": np.arange(20.0)}, sample_time=0.01)
    with pytest.raises(
        UserError, match=r"they differ in rope; a channel that has one value throughout may be a single number"
    ):
        gt.DataSet([a, b])


def test_it_does_not_scatter(crane: Path) -> None:
    """Seen: a standard deviation of 1.11e-16 m, which is rounding."""
    assert gt.inspect(load_dataset(crane)).content(crane.parent)["experiments"][0]["channels"]["rope"]["std"] == 0.0


def test_the_card_of_a_designed_recording_has_a_column_for_it(crane: Path) -> None:
    text = card_text(load_dataset(crane), np.arange(20) * 0.01, "motor.py:Motor", crane.parent)
    assert 'rope = { column = "rope", unit = "m" }' in text
    (crane.parent / "designed.toml").write_text(text)
    assert "rope" in read_card(crane.parent / "designed.toml").channels
