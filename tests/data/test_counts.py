"""Counts of an encoder where an angle is wanted, which nobody can tell the turns of; gravity beside accelerations."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.data import load_dataset
from greybox_torch.data.counts import ends_in_counts, in_turns, is_count, named_as_count
from greybox_torch.drafting.contradicted import contradictions
from greybox_torch.errors import UserError

MODEL = """
from greybox_torch import GreyBoxModel, Input, Output, Parameter, State


class Axis(GreyBoxModel):
    states, inputs, outputs = [State("angle", "rad")], [Input("current", "A")], [Output("angle", "rad")]
    parameters = [Parameter("k", 1.0, unit="rad/(A s)")]

    def derivative(self, x, u, p, port):
        return {"angle": p.k * u.current}

    def output(self, x, u, p):
        return {"angle": x.angle}
"""


def recorded(folder: Path, name: str, units: str = "") -> Path:
    rows = "".join(f"{k};{k % 7};{300 * k};{k % 5}\n" for k in range(40))
    (folder / "run.csv").write_text(f"t;current;{name};ref\n{units}{rows}")
    return folder / "run.csv"


def card(folder: Path, angle: str) -> Path:
    channels = f'[channels]\ncurrent = {{ column = "current", unit = "A" }}\nangle = {{ {angle} }}\n'
    (folder / "card.toml").write_text(f'time = "t"\n{channels}[[experiment]]\nname = "run"\nfile = "run.csv"\n')
    return folder / "card.toml"


@pytest.mark.parametrize(
    "angle", ['column = "enc", unit = "rad"', 'column = "enc", unit = "rad", file_unit = "counts"']
)
def test_counts_are_not_radians(tmp_path: Path, angle: str) -> None:
    """Seen: both passed every check, and 65536 counts were as many radians."""
    recorded(tmp_path, "enc", "s;A;counts;deg\n")
    with pytest.raises(
        UserError, match=r'"counts", the card says "rad"; how many counts has a turn\?.*"2\*pi\*enc/65536"'
    ):
        load_dataset(card(tmp_path, angle))
    data = load_dataset(card(tmp_path, 'expr = "2*pi*enc/65536", unit = "rad"'))
    np.testing.assert_allclose(data.recordings[0].signals["angle"][1], 2 * np.pi * 300 / 65536)
    assert load_dataset(card(tmp_path, 'column = "enc", unit = "1"')).recordings[0].signals["angle"][1] == 300.0


def test_counts_of_a_converter(tmp_path: Path) -> None:
    recorded(tmp_path, "enc", "s;A;raw;deg\n")
    with pytest.raises(UserError, match="how many m a count is"):
        load_dataset(card(tmp_path, 'column = "enc", unit = "m"'))


@pytest.mark.parametrize(
    ("name", "units", "expr"),
    [
        ("enc", "s;A;counts;deg\n", "2*pi*enc/65536"),
        ("enc_raw", "", "2*pi*enc_raw/65536"),
        ("encoder", "", "2*pi*encoder/65536"),
        ("angle_counts", "", "2*pi*angle_counts/65536"),
        ("enc 1", "", '2*pi*col(\\"enc 1\\")/65536'),
    ],
)
def test_a_card_proposes_the_expression(tmp_path: Path, name: str, units: str, expr: str) -> None:
    """Seen: "no column fits; left over: enc"."""
    (tmp_path / "axis.py").write_text(MODEL)
    drafted = gt.card([recorded(tmp_path, name, units)], f"{tmp_path / 'axis.py'}:Axis")
    assert f'# angle = {{ expr = "{expr}", unit = "rad" }}    # how many counts has a turn?' in drafted.text


def test_a_name_that_tells_counts(tmp_path: Path) -> None:
    recorded(tmp_path, "enc_counts")
    (found,) = contradictions(card(tmp_path, 'column = "enc_counts", unit = "rad"'))
    assert 'expr = "2*pi*enc_counts/65536"' in found.write
    assert not contradictions(card(tmp_path, 'column = "enc_counts", unit = "rad", scale = 0.001'))


def test_what_counts_are() -> None:
    assert all(map(is_count, ("counts", "[counts]", "ticks", "cnt", "counts/s", "LSB")))
    assert not any(map(is_count, ("rad", "deg", "1", "account", "c")))
    assert all(map(named_as_count, ("enc", "Encoder_2", "m1_enc", "pos_counts", "enc1")))
    assert not any(map(named_as_count, ("fence", "current", "encumbrance", "accounts", "speed")))
    assert ends_in_counts("enc [counts]") and not ends_in_counts("enc")
    assert [in_turns("e", unit) for unit in ("deg", "rev", "rad/s", "rpm")] == [
        "360*e/65536", "1*e/65536", "2*pi*e/65536", "60*e/65536",
    ]  # fmt: skip


def test_gravity_in_a_line_of_units(tmp_path: Path) -> None:
    """Seen: accelerations in m/s^2 were taken for multiples of gravity."""
    for told, unit, factor in (("m/s^2", "g", 1 / 9.80665), ("g", "m/s^2", 9.80665)):
        recorded(tmp_path, "acc", f"s;A;{told};deg\n")
        with pytest.raises(UserError, match="expected file_unit = "):
            load_dataset(card(tmp_path, f'column = "acc", unit = "{unit}"'))
        data = load_dataset(card(tmp_path, f'column = "acc", unit = "{unit}", file_unit = "{told}"'))
        assert data.recordings[0].signals["angle"][1] == pytest.approx(300.0 * factor)
