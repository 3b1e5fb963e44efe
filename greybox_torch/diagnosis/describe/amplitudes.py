"""How large the waves of a law are: of a cos nθ + b sin nθ the root of a² + b², which a drawing of a gear or a motor has."""

from __future__ import annotations

import math

import numpy as np

from greybox_torch.diagnosis.hypothesis.final import Final
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.waves import amplitudes


def wave_amplitudes(attachment: Attachment, final: Final) -> dict[str, tuple[float, float | None]]:
    """By the name of the sine's amplitude of every wave its size and one standard deviation of that; empty for a law without waves.

    The deviation is of the two together: an order that is not known exactly turns the one into the other, and leaves the size.
    """
    values, found = attachment.own(final.values()), dict[str, tuple[float, float | None]]()
    if not attachment.mechanism.repeats:
        return found
    for k in range(1, len(values)):
        names = amplitudes(k)
        if not set(names) <= set(values):
            break
        size = math.hypot(*(values[n] for n in names))
        if size > 0:
            slope = {f"{attachment.prefix}.{n}": values[n] / size for n in names}
            found[names[1]] = size, _deviation(final.told, slope)
    return found


def _deviation(final: Final, slope: dict[str, float]) -> float | None:
    """One standard deviation of a quantity of such ``slope`` by parameter; None where it is not known, or they are not determined."""
    free = list(final.problem.free_names)
    if final.uncertainty is None or not set(slope) <= set(free):
        return None
    places, by = [free.index(name) for name in slope], np.array(list(slope.values()))
    if set(places) & set(final.uncertainty.undetermined):
        return None
    kinds = (final.uncertainty.plain, final.uncertainty.sandwich)
    return float(np.sqrt(max(by @ kind[np.ix_(places, places)] @ by for kind in kinds)))
