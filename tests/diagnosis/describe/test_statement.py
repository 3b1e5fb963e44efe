"""What hypotheses that cannot be told apart have in common, in words."""

from __future__ import annotations

from dataclasses import replace

import pytest

from greybox_torch.diagnosis.describe.statement import Member, common_size, statement
from greybox_torch.mechanisms.library import BUILT_IN, LIBRARY

LAG = Member("actuator", "input_lag", "a time shift", 0.6, signal="torque", size=0.0011, unit="s")
DELAY = Member("sensor", "output_delay", "a time shift", 0.3, signal="speed", is_sensor=True, size=0.0012, unit="s")
BIAS = Member("motor", "constant_bias", "a constant offset", 0.5, size=0.031, unit="N m")
DRY = Member("motor", "coulomb_friction", "dry friction", 0.6, size=0.52, unit="N m")


@pytest.mark.parametrize(
    ("members", "words"),
    [
        ((LAG, DELAY), "about 1.1 ms pass between torque and measured speed"),
        ((LAG, replace(LAG, mechanism="input_delay")), "about 1.1 ms pass before torque acts"),
        ((DELAY, replace(DELAY, mechanism="sensor_lag", size=0.9)), "some time passes before speed is recorded"),
        ((LAG, replace(DELAY, size=1.5)), "some time passes between torque and measured speed"),
        ((DRY, replace(DRY, port="gearbox")), "dry friction of about 0.52 N m at motor or gearbox"),
        ((replace(DRY, size=700.1), replace(DRY, size=699.4)), "dry friction of about 700 N m at motor"),
        ((DRY, replace(DRY, port="table", unit="N")), "dry friction at motor or table"),
        ((DRY, replace(DRY, mechanism="presliding_hysteresis", size=None)), "dry friction at motor"),
        (
            (BIAS, replace(BIAS, port="actuator", size=-0.031)),
            "a constant offset of about 0.031 N m at motor or actuator",
        ),
        ((BIAS, DRY), "constant bias or Coulomb friction at motor"),
        ((BIAS, replace(DRY, port="arm")), "constant bias at motor, or Coulomb friction at arm"),
        (
            (replace(BIAS, mechanism="magnet", nature=""), replace(BIAS, port="arm", mechanism="magnet", nature="")),
            "magnet at motor, or magnet at arm",
        ),
    ],
)
def test_statement(members, words) -> None:
    assert statement(members) == words


def test_the_common_size_is_weighted_by_probability() -> None:
    far = replace(DRY, port="gearbox", probability=0.2, size=0.4)
    assert common_size((DRY, far)) == "0.49 N m"
    assert common_size((DRY, replace(far, size=0.3))) == ""


@pytest.mark.parametrize("name", sorted(BUILT_IN - {"unknown"}))
def test_every_law_says_what_it_has_in_common_with_others(name: str) -> None:
    assert LIBRARY[name].nature
