"""`diagnose` with the search as it is: refusals, numbers that fail, a time that is up."""

from __future__ import annotations

import json
import time
from typing import Any

import pytest

from greybox_torch.deadline import Deadline
from greybox_torch.diagnosis import pipeline
from greybox_torch.errors import NumericalError
from tests.commands.diagnosing import FILES, Edit, Make, diagnose, written


def test_numbers_that_fail(motor_folder: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: Any, **__: Any) -> None:
        raise NumericalError("the simulation overflows; try tighter bounds")

    monkeypatch.setattr(pipeline, "diagnose", fail)
    folder = motor_folder()
    result = diagnose(folder)
    assert result.exit_code == 3
    assert result.stderr.endswith("the numbers failed: the simulation overflows; try tighter bounds\n")
    assert (result.stdout, written(folder)) == ("", [])


def test_input_at_fault(motor_folder: Make, edit: Edit) -> None:
    folder = motor_folder()
    edit(folder / "dataset.toml", "speed = {", "sped = {")
    result = diagnose(folder)
    assert result.exit_code == 2
    assert "[channels] has no 'speed'" in result.stderr
    assert (result.stdout, written(folder)) == ("", [])


def test_nothing_to_estimate_from(motor_folder: Make) -> None:
    folder = motor_folder()
    card = folder / "dataset.toml"
    card.write_text(card.read_text().replace('"estimation"', '"validation"'))
    result = diagnose(folder)
    assert result.exit_code == 2
    assert 'no experiment has the role "estimation"' in result.stderr


@pytest.mark.parametrize("limit", ["0", "-3", "soon"])
def test_time_limits_that_are_none(motor_folder: Make, limit: str) -> None:
    """Seen: a line of progress before the error, and "unable to parse string as a number"."""
    refused = diagnose(motor_folder(), "--time-limit", limit)
    assert refused.exit_code == 2
    assert refused.stderr == f"error: --time-limit {limit}: expected seconds, a number above 0\n"


def test_a_time_limit_may_be_less_than_a_second(motor_folder: Make) -> None:
    """As in Python: any number above 0."""
    assert diagnose(motor_folder(), "--time-limit", "0.5").exit_code == 0


def test_a_users_own_model(motor_folder: Make) -> None:
    """The real search, on the documentation's motor: the dead zone of 0.4 V that the model does not know."""
    folder = motor_folder(dead_zone=0.4)
    result = diagnose(folder, "--json")
    assert result.exit_code == 0, result.stderr
    (effect,) = json.loads(result.stdout)["effects"]
    assert (effect["port"], effect["mechanism"]) == ("actuator", "actuator_deadzone")
    assert effect["parameters"]["half_width"]["value"] == pytest.approx(0.4, rel=0.02)
    assert [name for name in written(folder) if name != "hypotheses"] == FILES


def test_seeds_change_no_verdict(motor_folder: Make) -> None:
    folder = motor_folder(dead_zone=0.4)
    verdicts = [json.loads(diagnose(folder, "--json", "--seed", str(seed)).stdout) for seed in (0, 1, 2)]
    assert [v["seed"] for v in verdicts] == [0, 1, 2]
    for key in ("mismatch", "effects", "fit", "confidence"):
        assert verdicts[0][key] == verdicts[1][key] == verdicts[2][key]


def test_stopped(motor_folder: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    """On a clock by which the time is up at once: how far a real one lets the search get depends on the machine."""
    monkeypatch.setattr(Deadline, "after", lambda seconds: Deadline(time.perf_counter() + 0.01))
    folder = motor_folder(dead_zone=0.4)
    verdict = json.loads(diagnose(folder, "--json", "--time-limit", "1").stdout)
    assert verdict["complete"] is False and verdict["effects"] == []
    assert verdict["mismatch"] is True and "times the noise" in verdict["sentence"]
    assert written(folder) == FILES


def test_stopped_where_nothing_is_missing(motor_folder: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Deadline, "after", lambda seconds: Deadline(time.perf_counter() + 0.01))
    verdict = json.loads(diagnose(motor_folder(), "--json", "--time-limit", "1").stdout)
    assert verdict["mismatch"] is False


def test_without_a_compiler_it_says_so_at_once(motor_folder: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GREYBOX_COMPILER", "off")
    folder = motor_folder()
    result = diagnose(folder)
    assert result.exit_code == 2 and written(folder) == []
    assert (
        "a diagnosis needs a C++ compiler" in result.stderr and "pip install 'greybox_torch[compiler]'" in result.stderr
    )
