"""Which parameters of a law the recordings determine: in words, from their entries in `verdict.json`."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from greybox_torch.estimate.notes import with_value
from greybox_torch.name_lists import listed

Entries = Mapping[str, Mapping[str, Any]]


def told_undetermined(parameters: Entries, at_bounds: Collection[str]) -> str:
    """Which have a standard deviation above their value, or why none has one, in a sentence; "" elsewhere.

    Args:
        at_bounds: those at a bound, of which as much is said by that.
    """
    known = {n: (v.get("value"), v.get("std")) for n, v in parameters.items()}
    if known and all(std is None for _, std in known.values()):
        return (
            "no standard deviations are known: whole records were not fitted, as the search was stopped before or no simulation of a whole "
            "record keeps to it"
        )
    sizes = {n: (value, std) for n, (value, std) in known.items() if n not in at_bounds}
    names = [n for n, (value, std) in sizes.items() if value is not None and std is not None and std > abs(value)]
    if not names:
        return ""
    they, them = ("it", "it") if len(names) == 1 else ("they", "them")
    return (
        f"{', '.join(names)}: the standard deviation is larger than the value; {they} may be zero, or these recordings do not determine "
        f"{them} beside the other parameters"
    )


def listed_with_values(parameters: Entries, names: Collection[str]) -> str:
    """Those of ``names`` that are among the parameters, with their values: "width = 0 degC and F_c = 0.3 N m"."""
    there = [(name, parameters[name]) for name in names if name in parameters]
    return listed([with_value(name, float(entry["value"]), entry.get("unit", "")) for name, entry in there])
