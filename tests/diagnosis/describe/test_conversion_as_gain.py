"""A gain that is the factor of a unit is told as that."""

from __future__ import annotations

import math

import pytest

from greybox_torch.diagnosis.describe.conversion_as_gain import conversion_as_gain
from greybox_torch.mechanisms.actuator import InputBias, InputGain
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.sensor import SensorGain
from greybox_torch.mechanisms.surroundings import Surroundings


def told(law, unit: str, gain: float) -> str:
    signal = "output" if isinstance(law, SensorGain) else "input"
    around = Surroundings({}, {signal: unit}, unit, 0.01)
    return conversion_as_gain(Attachment("port", law), around, {"gain_error": {"value": gain - 1.0}, "bias": {}})


def test_a_torque_that_the_model_takes_for_one_in_si_units() -> None:
    """Seen: lbf in for N m, told as an input gain of -0.887 (0.97) and nothing besides."""
    said = told(InputGain(), "lbf in", 0.11298)
    assert (
        said
        == "1 + gain_error is 0.113, which is one lbf in in SI units: the model's equations may lack that conversion"
    )


def test_an_output_that_the_model_gives_in_si_units() -> None:
    said = told(SensorGain(), "rpm", 30.05 / math.pi)
    assert (
        said == "1 + gain_error is 9.565, which is one SI unit in rpm: the model's equations may lack that conversion"
    )


@pytest.mark.parametrize(
    ("law", "unit", "gain"),
    [
        (InputGain(), "lbf in", 0.12),
        (InputGain(), "lbf in", 1.0 / 0.113),
        (SensorGain(), "rpm", 0.1047),
        (InputGain(), "N m", 0.113),
        (InputGain(), "", 0.113),
        (InputGain(), "no unit", 0.113),
        (InputBias(), "lbf in", 0.113),
    ],
    ids=["another gain", "the inverse", "the inverse at a sensor", "SI", "none", "unknown", "another law"],
)
def test_elsewhere_nothing_is_said(law, unit: str, gain: float) -> None:
    assert told(law, unit, gain) == ""
