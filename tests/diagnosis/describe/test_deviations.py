"""Standard deviations of an effect's parameters: known, infinite, or not computed."""

from __future__ import annotations

import math

from greybox_torch.diagnosis.describe.effects import _parameters
from greybox_torch.model import Parameter


def test_what_is_not_determined_is_told_from_what_was_not_computed(stub) -> None:
    """Seen: nothing in the table for either, and no word why."""
    names = {"gear.ripple.a": "N m", "gear.ripple.b": "N m", "gear.ripple.order": "", "J": "kg m^2"}
    model = stub(declared_parameters=[Parameter(name, 1.0, unit=unit) for name, unit in names.items()])
    told = stub(deviations=lambda: {"gear.ripple.a": 0.1, "gear.ripple.b": math.inf})
    final = stub(values=lambda: dict.fromkeys(names, 1.0), told=told)
    found = _parameters(model, stub(prefix="gear.ripple"), final)
    assert {name: entry["std"] for name, entry in found.items()} == {"a": 0.1, "b": math.inf, "order": None}


def test_parameters_have_their_meaning(stub) -> None:
    """Seen: F_c, F_s, v_s and v_0 in the report without a word of what they are."""
    model = stub(
        declared_parameters=[Parameter("belt.stribeck_friction.v_s", 0.1, unit="m/s", description="Stribeck speed")]
    )
    final = stub(values=lambda: {"belt.stribeck_friction.v_s": 0.1}, told=stub(deviations=lambda: {}))
    found = _parameters(model, stub(prefix="belt.stribeck_friction"), final)
    assert found["v_s"]["description"] == "Stribeck speed"
