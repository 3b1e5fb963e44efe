"""The states that carry a change of a coupling's deflection, and how they are written."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from greybox_torch.model import Signals

TERM = re.compile(r"(?P<sign>[+-])(?:(?P<factor>\d+(?:\.\d*)?(?:e[+-]?\d+)?)\*)?(?P<name>[A-Za-z_][\w.]*)")


def written(per_deflection: Mapping[str, float]) -> str:
    """``+name`` or ``-name`` for each state, with a factor where it does not move as far as the deflection changes: ``+100.0*name`` of a
    gear, ``+q+twist`` where a twist may change and what follows from both may not.
    """
    return "".join(_term(name, by) for name, by in per_deflection.items())


def _term(name: str, per_deflection: float) -> str:
    sign, factor = "+" if per_deflection > 0 else "-", abs(per_deflection)
    return f"{sign}{name}" if abs(factor - 1.0) < 1e-9 else f"{sign}{factor!r}*{name}"


def read(shifted_state: str) -> dict[str, float]:
    """By state, by how much it moves for a change of the deflection by one."""
    return {
        term["name"]: float(term["factor"] or 1.0) * (1.0 if term["sign"] == "+" else -1.0)
        for term in TERM.finditer(shifted_state)
    }


def moved(x: Signals, shifted_state: str, change: Any) -> Signals:
    """The states ``x`` where a coupling's deflection changes by ``change``."""
    return x.replaced(**{name: x[name] + by * change for name, by in read(shifted_state).items()})
