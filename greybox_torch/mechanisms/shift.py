"""The state that carries a change of a coupling's deflection, and how it is written."""

from __future__ import annotations


def written(name: str, per_deflection: float) -> str:
    """``+name`` or ``-name``, with a factor where the state does not move as far as the deflection changes: ``+100.0*name`` of a gear."""
    sign, factor = "+" if per_deflection > 0 else "-", abs(per_deflection)
    return f"{sign}{name}" if abs(factor - 1.0) < 1e-9 else f"{sign}{factor!r}*{name}"


def read(shifted_state: str) -> tuple[str, float]:
    """The state, and by how much it moves for a change of the deflection by one."""
    factor, _, name = shifted_state[1:].rpartition("*")
    return name, float(factor or 1.0) * (1.0 if shifted_state[0] == "+" else -1.0)
