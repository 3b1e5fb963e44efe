"""An unknown effect whose curve is a straight line, as one would write it into the model's class.

The commonest omission in models of rooms, vessels and drives is a recorded input, or a loss, that acts in proportion. The library has no
name for it, and a curve of a dozen heights does not say how simple it is.
"""

from __future__ import annotations

import numpy as np

from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.effect import Curve
from greybox_torch.model import Balance, Body, Coupling
from greybox_torch.model.ports import Port

STRAIGHT = 0.01
"""Share of a curve's variance along the records up to which what is left of a straight line is the imprecision of its heights."""

FEWEST_PLACES = 3
"""Places along a curve that the records have to visit: through two there is always a line."""

NEXT_TO_NOTHING = 0.03
"""Share of its reach up to which what a line is at zero is left out."""


def straight_line(curve: Curve | None, site: Port, signal: str) -> str:
    """``port.NAME += slope * signal + constant`` where a learned curve is a straight line over what the records visit; "" elsewhere.

    With a factor: where the curve is the same everywhere, what multiplies it. Nor is there one where the model has no name for a signal, as
    for a difference of two levels, which acts at both, and where only one or two values of it were visited.

    Args:
        signal: the model's own name of what the curve is over.
    """
    if curve is None:
        return ""
    name = signal if curve.factor is None else curve.factor.signal
    few = curve.seen is not None and np.count_nonzero(curve.seen) < FEWEST_PLACES
    if not isinstance(site, Body | Coupling | Balance) or not name.isidentifier() or few:
        return ""
    visits = _visits(curve)
    mean = float(np.average(curve.force, weights=visits))
    variance = float(np.average((curve.force - mean) ** 2, weights=visits))
    if curve.factor is not None:
        flat = variance < STRAIGHT * mean**2 and curve.factor.value != 0
        return f"port.{site.name} += {digits(mean / curve.factor.value, 3)} * {name}" if flat else ""
    slope, at_zero = np.polyfit(curve.values, curve.force, 1, w=np.sqrt(visits))
    left = curve.force - slope * curve.values - at_zero
    if not variance or np.average(left**2, weights=visits) > STRAIGHT * variance:
        return ""
    nothing = abs(at_zero) < NEXT_TO_NOTHING * np.ptp(curve.force)
    return as_equation(site.name, float(slope), 0.0 if nothing else float(at_zero), name)


def as_equation(port: str, slope: float, at_zero: float, signal: str, factor: str = "") -> str:
    """``port.NAME += slope * signal + constant``, all of it times a factor where there is one."""
    line = f"{digits(slope, 3)} * {signal}"
    if at_zero:
        line += f" {'-' if at_zero < 0 else '+'} {digits(abs(at_zero), 3)}"
    if not factor:
        return f"port.{port} += {line}"
    line, factor = f"({line})" if at_zero else line, factor if factor.isidentifier() else f"({factor})"
    return f"port.{port} += {line} * {factor}"


def _visits(curve: Curve) -> np.ndarray:
    """How many samples lie near each value of the curve (n,)."""
    if curve.seen is None or not curve.seen.any():
        return np.ones(len(curve.values))
    share = (curve.values - curve.values[0]) / (curve.values[-1] - curve.values[0])
    return curve.seen[np.minimum((share * len(curve.seen)).astype(int), len(curve.seen) - 1)].astype(float)
