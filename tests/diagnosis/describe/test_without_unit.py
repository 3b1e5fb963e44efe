"""Where a law's parameters have no unit it is told why."""

from __future__ import annotations

from dataclasses import replace

from greybox_torch.diagnosis.describe.without_unit import without_unit
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.model import Balance

AROUND = Surroundings({"level": Range(180.0, 440.0, 300.0)}, {"level": "mm"}, "", 5.0)
TANK = Balance("tank", level="level")
OVERFLOW = Attachment("tank", LIBRARY["threshold_flow"]())


def test_a_flow_whose_unit_the_equations_do_not_tell() -> None:
    """Seen: c of an overflow without a unit, beside a threshold in mm, and no word of why."""
    told = {name: {"value": 1.0, "unit": unit} for name, unit in (("c", ""), ("threshold", "mm"), ("width", "mm"))}
    assert without_unit(OVERFLOW, TANK, AROUND, told) == (
        "c has no unit, as the model's equations do not tell that of port.tank: they do not divide it by one parameter with a unit, such "
        "as a capacity or an inertia"
    )
    assert without_unit(OVERFLOW, TANK, replace(AROUND, force_unit="m^3/s"), told) == ""
    assert without_unit(OVERFLOW, TANK, AROUND, {"threshold": told["threshold"]}) == ""
