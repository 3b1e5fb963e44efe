"""What is known beforehand: read from a card, weighed among rivals, and kept out of the search where it is excluded."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.signal import lfilter

import greybox_torch as gt
from greybox_torch.diagnosis.beliefs import NO_BELIEFS, Beliefs, beliefs_from_mapping
from greybox_torch.errors import UserError
from greybox_torch.systems import RobotArm

WHERE = "dataset.toml: [beliefs]"


def test_an_entry_of_both_names_stands_alone_and_others_add() -> None:
    given = {
        "motor/*": "likely",
        "*/backlash": "unlikely",
        "*/input_delay": 0.8,
        "actuator/*": 0.8,
        "gear_spring/backlash": 0.5,
    }
    beliefs = beliefs_from_mapping(given, RobotArm(), WHERE)
    assert beliefs.log_odds("motor", "gravity") == pytest.approx(math.log(9.0))
    assert beliefs.log_odds("arm_spring", "backlash") == pytest.approx(-math.log(9.0))
    assert beliefs.log_odds("gear_spring", "backlash") == 0.0
    assert beliefs.log_odds("actuator", "input_delay") == pytest.approx(math.log(16.0))
    assert beliefs.log_odds("arm", "gravity") == 0.0
    assert NO_BELIEFS.log_odds("arm", "gravity") == 0.0


def test_zero_excludes_whatever_else_is_said() -> None:
    beliefs = Beliefs({"gear_spring/*": 0.0, "*/backlash": 0.9, "gear_spring/hysteretic_spring": 0.5})
    assert beliefs.log_odds("gear_spring", "backlash") == -math.inf
    assert beliefs.log_odds("gear_spring", "hysteretic_spring") == 0.0  # but for what is said of it alone


@pytest.mark.parametrize(
    ("key", "value", "told"),
    [
        ("gear_sprin/backlash", 0.1, 'model robot_arm has no port "gear_sprin" (did you mean "gear_spring"?)'),
        ("gear_spring/backlsh", 0.1, 'there is no mechanism "backlsh" (did you mean "backlash"?)'),
        ("gear_spring/gravity", 0.1, 'gear_spring is a port of the kind "coupling"; gravity attaches to body'),
        (
            "backlash",
            0.1,
            '"backlash" is no hypothesis; expected "PORT/MECHANISM", with * in the place of either for any',
        ),
        ("*/*", 0.1, '"*/*" is no hypothesis'),
        ("a/b/c", 0.1, '"a/b/c" is no hypothesis'),
        (3, 0.1, '"3" is no hypothesis'),
        (
            "motor/*",
            "sure",
            "found 'sure'; expected 'unlikely', 'likely', or a probability from 0 (excluded) to below 1",
        ),
        ("motor/*", 1.0, "found 1.0"),
        ("motor/*", -0.1, "found -0.1"),
        ("motor/*", float("nan"), "found nan"),
        ("motor/*", True, "found True"),
        ("motor/*", {"p": 1}, "found {'p': 1}"),
    ],
)
def test_messages(key: Any, value: Any, told: str) -> None:
    with pytest.raises(UserError) as error:
        beliefs_from_mapping({key: value}, RobotArm(), WHERE)
    assert str(error.value).startswith(WHERE) and told in str(error.value)


def test_what_is_given_is_checked_before_anything_is_computed(motor_data, motor) -> None:
    data = motor_data(200)
    with pytest.raises(UserError, match='argument beliefs: "roter/gravity": model Motor has no port "roter"'):
        gt.diagnose(motor, data, beliefs={"roter/gravity": 0.5})
    with pytest.raises(UserError) as error:
        beliefs_from_mapping(
            {"roter/gravity": 0.1, "rotor/gravity": 2, "rotor/coulomb_friction": 0.1}, motor, "card: [beliefs]"
        )
    lines = str(error.value).splitlines()  # seen: one at a time
    assert lines[0] == "card: [beliefs]: 2 problems:" and len(lines) == 3
    assert lines[1].startswith('  "roter/gravity": model Motor has no port') and lines[2].startswith(
        '  "rotor/gravity": found 2;'
    )
    with pytest.raises(UserError, match="argument beliefs: found 3, expected a table"):
        gt.diagnose(motor, data, beliefs=3)  # type: ignore[arg-type]


def hypotheses(found: gt.DiagnosisResult) -> set[tuple[str, str]]:
    """Every hypothesis that a verdict speaks of."""
    told = {(port, mechanism) for port, mechanism, *_ in found.verdict.ranking}
    for e in found.effects:
        told |= {(e.port, e.mechanism), *((a.port, a.mechanism) for a in e.alternatives)}
        told |= set() if e.one_of is None else {(m.port, m.mechanism) for m in e.one_of.members}
    return told


def test_a_lag_is_placed_where_it_is_believed_to_be(motor_data, motor) -> None:
    """From voltage to speed a lag of the input is one of the output: the leading member follows the belief, the other one stays."""
    data = motor_data(600, acting=lambda v: lfilter([0.6], [1.0, -0.4], v))
    lags, decided = {"actuator": "input_lag", "sensor": "sensor_lag"}, []
    for side, lag in lags.items():
        found = gt.diagnose(motor, data, beliefs={f"{side}/*": "likely", "rotor/*": 0.0})
        (effect,) = found.effects
        assert (effect.port, effect.mechanism) == (side, lag)
        (other,) = (a for a in effect.alternatives if a.mechanism in lags.values())
        assert effect.probability / other.probability == pytest.approx(9.0, rel=0.3)
        assert effect.one_of is not None and effect.one_of.probability > 0.9
        assert not any(port == "rotor" for port, _ in hypotheses(found))
        (b, j), verdict = sorted(found.verdict.parameters, key=lambda p: p.name, reverse=True)[:2], found.verdict
        assert {p.name for p in verdict.parameters} == {"J", "b"} and b.augmented is not None
        assert b.augmented[0] == found.parameters["b"].value and (b.augmented[1] or 0.0) > 0.0 and j.unit == "kg m^2"
        assert found.to_dict()["beliefs"] == {f"{side}/*": 0.9, "rotor/*": 0.0}
        decided.append(any("what is believed beforehand decides" in s for s in verdict.evidence))
    assert sum(decided) == 1  # the recordings alone put one of the two first, by next to nothing


def test_friction_in_the_place_of_a_bias(motor_data, motor) -> None:
    """A motor that turns one way: a constant torque against it is friction as well. The recordings take the simpler law."""

    def positive(voltage):
        return 3.0 + voltage / 3.0

    turned = motor_data(600, torque=lambda place, speed: -0.03, acting=positive)
    recordings = [
        gt.Recording.from_arrays(
            r.name,
            {"voltage": positive(r.signals["voltage"]), "speed": r.signals["speed"]},
            sample_time=r.sample_time,
            role=r.role,
        )
        for r in turned.recordings
    ]
    beliefs = {"*/sensor_bias": 0.0, "actuator/*": 0.0, "rotor/coulomb_friction": 0.99}
    found = gt.diagnose(motor, gt.DataSet(recordings, beliefs=beliefs))
    assert [(e.port, e.mechanism) for e in found.effects] == [("rotor", "coulomb_friction")]
    assert ("rotor", "constant_bias") in hypotheses(found)
    assert not any(port == "actuator" or mechanism == "sensor_bias" for port, mechanism in hypotheses(found))


def test_everything_excluded(motor_data, motor) -> None:
    """Nothing is left to look for, and nothing is named."""
    data = motor_data(600, torque=lambda place, speed: -0.2 * np.tanh(speed))
    found = gt.diagnose(motor, data, beliefs={"rotor/*": 0.0, "actuator/*": 0.0, "sensor/*": 0.0})
    assert not found.effects and not hypotheses(found) and found.verdict.complete
    assert not found.verdict.looked and "the beliefs exclude every hypothesis" in found.sentence
    assert "Nothing is missing" not in found.sentence and "curve of one signal explains" not in found.sentence
