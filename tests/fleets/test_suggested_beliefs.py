"""What a fleet says beforehand of a further machine of its model."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import replace

import pytest

import greybox_torch as gt
from greybox_torch.api.fleet_result import FleetResult
from greybox_torch.fleets.row import Row
from greybox_torch.fleets.suggested_beliefs import HIGHEST, suggested_beliefs


@pytest.fixture
def rows(coulomb: Callable[..., Row]) -> list[Row]:
    """Six machines with Coulomb friction, two with drag, one with a lag, one without anything."""
    found = [coulomb(f"c{k}", 0.3) for k in range(6)]
    drag = {"mechanism": "quadratic_drag", "effect": "quadratic drag at rotor"}
    found += [replace(coulomb(f"d{k}", 0.3), **drag) for k in range(2)]
    found += [replace(coulomb("l", 0.3), port="actuator", mechanism="input_lag", effect="input lag at actuator")]
    return [*found, coulomb("healthy", None)]


def test_odds_are_those_of_the_rule_of_succession(rows: list[Row]) -> None:
    """Six machines: seven times as likely as what was never found. One machine alone says nothing."""
    (one,) = suggested_beliefs(rows)
    assert one.found == {"rotor/coulomb_friction": 6, "rotor/quadratic_drag": 2}
    assert one.beliefs == {"rotor/coulomb_friction": 0.875, "rotor/quadratic_drag": 0.75}
    assert (one.model, one.of, one.file) == ("Motor", 10, "beliefs_Motor.toml")


def test_a_machine_counts_once(coulomb: Callable[..., Row]) -> None:
    assert suggested_beliefs([coulomb("c", 0.3, month=month) for month in range(1, 10)]) == ()


def test_many_machines_leave_room_for_another_kind(coulomb: Callable[..., Row]) -> None:
    (one,) = suggested_beliefs([coulomb(f"c{k}", 0.3) for k in range(100)])
    assert one.beliefs == {"rotor/coulomb_friction": HIGHEST}


def test_what_is_left_open_between_names_does_not_count(coulomb: Callable[..., Row]) -> None:
    several = "about 1 ms pass between voltage and speed"
    assert suggested_beliefs([replace(coulomb(f"c{k}", 0.3), effect=several) for k in range(9)]) == ()


def test_the_table_goes_into_a_card(rows: list[Row], machines: object) -> None:
    """It is taken by a diagnosis as it stands."""
    from greybox_torch.diagnosis.beliefs import beliefs_from_mapping

    (one,) = FleetResult(tuple(rows)).suggested_beliefs
    table = tomllib.loads(one.toml())["beliefs"]
    assert table == one.beliefs
    believed = beliefs_from_mapping(table, gt.load_model(f"{machines}/small.py:Rotor"), "[beliefs]")
    assert believed.log_odds("rotor", "coulomb_friction") > believed.log_odds("rotor", "quadratic_drag") > 0.0


def test_the_result_writes_it(rows: list[Row], tmp_path: object) -> None:
    result = FleetResult(tuple(rows))
    written = {path.name for path in result.save(str(tmp_path))}
    assert "beliefs_Motor.toml" in written
    assert result.to_dict()["beliefs"][0]["found"] == {"rotor/coulomb_friction": 6, "rotor/quadratic_drag": 2}
    assert "beliefs_Motor.toml" in str(result)
