"""What to write where a channel of a card is in another unit than the model's."""

from __future__ import annotations

from pathlib import Path

import pytest

import greybox_torch as gt
from greybox_torch.errors import UserError
from greybox_torch.simulation.records import check_channels


class Kiln(gt.GreyBoxModel):
    states, inputs, outputs = [gt.State("T", "degC")], [gt.Input("heat", "kW")], [gt.Output("T", "degC")]


@pytest.mark.parametrize(
    ("column", "entry", "told"),
    [
        ("Heat [kW]", 'unit = "W"', 'expected unit = "kW" without file_unit, as column "Heat [kW]" is in it'),
        ("Heat [kW]", 'unit = "W", file_unit = "kW"', 'expected unit = "kW" without file_unit'),
        ("Heat [MW]", 'unit = "W"', 'expected unit = "kW" with file_unit = "MW"'),
        ("Heat", 'unit = "W"', 'expected unit = "kW" with file_unit = "W"'),
        ("Heat [kW]", 'unit = "W", scale = 1000.0', 'expected unit = "kW" with file_unit = "W"'),
        (
            "Heat", 'unit = "kWatt"',
            "'kWatt' is no unit that is known; expected unit = \"kW\", and, where the file is in another unit, "
            'with file_unit, a known unit such as "W", "kW", "MW", or a scale',
        ),
        ("Heat [kW]", 'unit = "kWatt"', "'kWatt' is no unit that is known; expected unit = \"kW\" without"),
        ("Heat", 'unit = "kW", file_unit = "kWatt"', '"kWatt" is no unit that is known; expected units such as "W"'),
    ],
)  # fmt: skip
def test_the_unit_of_the_file_is_asked_for(tmp_path: Path, column: str, entry: str, told: str) -> None:
    """Seen: of a column in kW 'expected unit = "kW" with file_unit = "W"', and file_unit = "kWatt", which was refused as unknown."""
    rows = [f"{k},{k % 7},20" for k in range(60)]
    (tmp_path / "a.csv").write_text("\n".join([f"t,{column},T", *rows]))
    (tmp_path / "dataset.toml").write_text(
        f'time = "t"\n[channels]\nheat = {{ column = "{column}", {entry} }}\nT = {{ column = "T", unit = "degC" }}\n'
        '[[experiment]]\nname = "A"\nfile = "a.csv"\n'
    )
    with pytest.raises(UserError) as error:
        check_channels(gt.load_dataset(tmp_path / "dataset.toml"), Kiln())
    assert told in str(error.value)
