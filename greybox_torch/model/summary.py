"""A model in a few lines, for those who print it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from greybox_torch.in_unit import in_unit
from greybox_torch.model.declarations import Parameter

MOST_LINES = 40
"""Parameters that are shown: a network has hundreds."""


def summary(title: str, effects: Sequence[str], parameters: Sequence[Parameter], values: Mapping[str, float]) -> str:
    """The title, the effects, and every parameter with its value and unit."""
    lines = [f"{title} with {', '.join(effects)}" if effects else title]
    for p in parameters[:MOST_LINES]:
        lines.append(in_unit(f"  {p.name} = {values[p.name]:.6g}", p.unit) + (" (fixed)" if p.fixed else ""))
    left = len(parameters) - MOST_LINES
    return "\n".join([*lines, *([f"  and {left} more parameters"] if left > 0 else [])])
