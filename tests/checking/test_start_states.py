"""States that begin as measured, and that no output or input of the model measures."""

from __future__ import annotations

import re

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.errors import UserError


class Winch(gt.GreyBoxModel):
    states = (
        gt.State("motor_speed", "rad/s", initial="measured"),
        gt.State("drum_speed", "rad/s", initial="measured"),
        gt.State("drum_angle", "rad", initial="measured"),
    )
    inputs = (gt.Input("torque", "N m"),)
    outputs = (gt.Output("motor_rpm", "rpm"), gt.Output("angle", "rad"))
    parameters = (gt.Parameter("J", 1.0, unit="kg m^2", lower=0.0),)

    def derivative(self, x, u, p, port):
        return {
            "motor_speed": u.torque / p.J,
            "drum_speed": (x.motor_speed - x.drum_speed) * 1.0,
            "drum_angle": x.drum_speed,
        }

    def output(self, x, u, p):
        return {"motor_rpm": x.motor_speed * 9.55, "angle": x.drum_angle}


def data(**given: float) -> gt.DataSet:
    units = {"torque": "N m", "motor_rpm": "rpm", "angle": "rad"}
    signals = {name: np.sin(0.1 * np.arange(100)) for name in units}
    run = gt.Recording.from_arrays("run", signals, sample_time=0.1, units=units)
    return gt.DataSet([run], initial=given)


def starts(found: gt.CheckResult) -> list[str]:
    return [f.found for f in found.findings if "initial is" in f.found]


def test_all_are_told_without_data() -> None:
    """Seen: "nothing is wrong with it that shows without data", and with a card the first of them alone."""
    found = gt.check(Winch())
    assert found.usable, "a card may give them"
    assert not gt.check(Winch(), data()).usable
    one, other = starts(found)
    assert one == (
        "state 'motor_speed': initial is \"measured\", but no output is this state, and there is not exactly one output or input in its "
        "unit rad/s; the outputs are motor_rpm in rpm, angle in rad"
    )
    assert other.startswith("state 'drum_speed': initial is")


def test_a_card_may_say_where_they_begin() -> None:
    assert len(starts(gt.check(Winch(), data(drum_speed=0.0)))) == 1
    assert not starts(gt.check(Winch(), data(drum_speed=0.0, motor_speed=1.0)))


def test_a_simulation_is_refused_for_all_at_once() -> None:
    with pytest.raises(UserError, match=re.compile("model Winch: 2 problems:.*motor_speed.*drum_speed", re.DOTALL)):
        gt.simulate(Winch(), data())


class Zone(gt.GreyBoxModel):
    states = (gt.State("air", "degC", initial="measured"), gt.State("wall", "degC", initial="measured"))
    inputs = (gt.Input("heat", "W"),)
    outputs = (gt.Output("air", "degC"),)
    parameters = (gt.Parameter("C", 1.0, unit="J/K"), gt.Parameter("k", 1.0, unit="W/K"))

    def derivative(self, x, u, p, port):
        flow = p.k * (x.wall - x.air)
        return {"air": (u.heat + flow) / p.C, "wall": -flow / p.C}

    def output(self, x, u, p):
        return {"air": x.air}


def test_a_start_that_shows_another_state_is_noted() -> None:
    """Seen: a wall that began at the air's temperature without a word."""
    (note,) = (f for f in gt.check(Zone()).findings if "first sample" in f.found)
    assert note.level == "note" and note.found.startswith("state 'wall' begins with the first sample of air")
    assert 'State("wall", …, initial=…), or wall = { value = … } under [model.initial] on the card' in note.write
