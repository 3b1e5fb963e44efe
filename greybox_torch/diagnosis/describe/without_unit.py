"""Why parameters of a law have no unit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.surroundings import Surroundings
from greybox_torch.model.ports import Port
from greybox_torch.name_lists import listed


def without_unit(
    attachment: Attachment, site: Port, around: Surroundings, parameters: Mapping[str, Mapping[str, Any]]
) -> str:
    """A clause where what acts at the port has no unit, and so parameters of the law have none; "" elsewhere.

    Seen: the flow of an overflow per level without a unit, in the table and on the axis, and no word of why.
    """
    law = attachment.mechanism
    if around.force_unit or law.free:
        return ""
    known = {p.name: p.unit for p in law.parameters(replace(around, force_unit="N"))}
    names = [p.name for p in law.parameters(around) if p.name in parameters and p.unit != known.get(p.name)]
    if not names:
        return ""
    have = "has" if len(names) == 1 else "have"
    return (
        f"{listed(names)} {have} no unit, as the model's equations do not tell that of port.{site.name}: they do not divide it by one "
        "parameter with a unit, such as a capacity or an inertia"
    )
