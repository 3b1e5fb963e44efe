"""A gain that is the factor between a declared unit and that of the SI: what lacks may be a conversion in the model, and no physics."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from greybox_torch.data.units import in_base_units
from greybox_torch.diagnosis.digits import digits
from greybox_torch.mechanisms.actuator import InputGain
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.sensor import SensorGain
from greybox_torch.mechanisms.surroundings import Surroundings

NEAR = 0.02
"""Relative difference up to which a gain is taken for the factor: parameters of the model may make up for some of it."""


def conversion_as_gain(
    attachment: Attachment, around: Surroundings, parameters: Mapping[str, Mapping[str, Any]]
) -> str:
    """A clause where 1 + ``gain_error`` is what one unit of the signal is in base units, or the inverse at a sensor; "" elsewhere.

    Seen: a model that took a torque in lbf in for one in N m, told as a gain error of -0.887 (0.97).
    """
    law = attachment.mechanism
    if not isinstance(law, InputGain | SensorGain):
        return ""
    at_sensor = isinstance(law, SensorGain)
    unit = around.units.get("output" if at_sensor else "input", "")
    factor = in_base_units(unit) if unit else None
    if factor is None or abs(factor - 1.0) < NEAR:
        return ""
    gain, lacking = 1.0 + float(parameters["gain_error"]["value"]), 1.0 / factor if at_sensor else factor
    if abs(gain / lacking - 1.0) > NEAR:
        return ""
    return (
        f"1 + gain_error is {digits(gain, 4)}, which is {'one SI unit in' if at_sensor else 'one'} {unit}"
        f"{'' if at_sensor else ' in SI units'}: the model's equations may lack that conversion"
    )
