"""An encoder's counts are offered for one angle, and for no rate: that is a column of a rate's unit."""

from __future__ import annotations

from pathlib import Path

import pytest

import greybox_torch as gt

MODEL = """from greybox_torch import Body, GreyBoxModel, Input, Output, Parameter, State

class Joint(GreyBoxModel):
    states = [State("motor_angle", "rad"), State("motor_speed", "rad/s")]
    inputs = [Input("current", "A")]
    outputs = [Output("motor_angle", "rad"), Output("link_rate", "rad/s"){more}]
    parameters = [Parameter("J", 1.0, unit="kg m^2", lower=0.01)]
    ports = [Body("motor", speed="motor_speed", position="motor_angle")]

    def derivative(self, x, u, p, port):
        return {{"motor_angle": x.motor_speed, "motor_speed": (u.current + port.motor) / p.J}}

    def output(self, x, u, p):
        return {{output.name: x.motor_speed for output in self.outputs}}
"""


def columns(folder: Path, header: str, more: str = "") -> dict[str, tuple[str | None, str]]:
    """By channel its column, and what may be meant of counts."""
    rows = [f"{0.002 * k},{k % 7},{3 * k % 11},{0.1 * k % 5:.3f}" for k in range(40)]
    (folder / "run.csv").write_text("\n".join([header, *rows]))
    (folder / "joint.py").write_text(MODEL.format(more=more))
    drafted = gt.card([folder / "run.csv"], f"{folder / 'joint.py'}:Joint")
    return {draft.name: (draft.column, draft.expr) for draft in drafted.draft.channels}


def test_a_rate_is_the_column_in_its_unit(tmp_path: Path) -> None:
    """Seen: enc_cnt was offered for the angle and for the rate, though gyro_z_dps stood there."""
    found = columns(tmp_path, "t,i_mot_mA,enc_cnt,gyro_z_dps")
    assert found["link_rate"] == ("gyro_z_dps", "")
    assert found["motor_angle"] == (None, "2*pi*enc_cnt/65536")


def test_counts_are_offered_once(tmp_path: Path) -> None:
    found = columns(tmp_path, "t,i_mot_mA,enc_cnt,temp", ', Output("other_angle", "rad")')
    assert [name for name, (_, expr) in found.items() if "enc_cnt" in expr] == ["motor_angle"]


@pytest.mark.parametrize(("header", "expr"), [("enc [counts/s]", True), ("enc [counts]", False)])
def test_counts_per_second_may_be_a_rate(tmp_path: Path, header: str, expr: bool) -> None:
    found = columns(tmp_path, f"t,i_mot_mA,motor_angle,{header}")
    assert bool(found["link_rate"][1]) == expr and found["link_rate"][0] is None
