"""Whether a channel is read with another scale than it was recorded in, or a temperature from another zero: asked where an estimate
simulates the validation experiments badly.

Free parameters make up for a part of a wrong scale, so that a refit alone does not tell 100 from 60. The start values, which are right
within less than that on most cards, do.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from greybox_torch.api.short_refits import (
    AS_GOOD,
    AS_IT_IS,
    FOLLOWS,
    REFITTED,
    Asked,
    Change,
    as_it_is,
    beginnings,
    far_better,
    fit_after,
    is_far_better,
    judging,
    values_without,
)
from greybox_torch.data import DataSet
from greybox_torch.data.units import conversion, per_minute
from greybox_torch.diagnosis.digits import digits
from greybox_torch.estimate.comparison import Score, fits_by_output, held_out_scores, mean_fit
from greybox_torch.model import GreyBoxModel
from greybox_torch.name_lists import listed
from greybox_torch.simulation.simulator import Simulator

DECADES = (10.0, 100.0, 1000.0)
"""Factors that any channel may be read with too much or too little."""

PER_MINUTE, DEGREES, TURNS_PER_MINUTE = 60.0, 180.0 / np.pi, 30.0 / np.pi
"""Those of units with a time, of units with an angle, and of angular speeds."""

BAR = 1e5
"""Pascals in a bar."""

QUADRATURE = 4.0
"""Counts of an encoder for one of its lines: all edges of both of its tracks."""

TEMPERATURES = ("degC", "K", "degF")

POSITIONS = ("rad", "mrad", "deg", "°", "m", "mm")
"""Units of what an encoder shows."""

_ANGULAR_SPEED = re.compile(r"(m?rad|deg|°)\s*/\s*(s|min)|rpm")

MOST_CHANNELS = 8
"""Inputs, and outputs, up to which each is tried with every factor: seven simulations or so for one."""


def rescaled(data: DataSet, model: GreyBoxModel, simulator: Simulator, achieved: float) -> Asked | None:
    """A question to the user, where other values of one channel, by a factor or a zero that units differ by, make a short refit far better
    on the validation experiments than these are as they stand; else None. Only changes are refitted with which the start values alone
    simulate better.

    Arguments as for :func:`greybox_torch.api.exchanged.exchanged`.
    """
    short, changes = beginnings(data), list(_changes(model))
    if short is None or not changes:
        return None
    as_begun = fit_after(short, model, simulator, AS_IT_IS, refitted=False)
    by_start = {k: fit_after(short, model, simulator, change, refitted=False) for k, change in enumerate(changes)}
    nearer = [k for k, fit in by_start.items() if fit > as_begun]
    tried = [changes[k] for k in sorted(nearer, key=lambda k: -by_start[k])[:REFITTED]]
    found = far_better(short, model, simulator, tried, achieved) if tried else None
    if found is None:
        return None
    left, lefts = found
    # in the order of what the start values say
    told, rest = next(pair for pair in zip(tried, lefts, strict=True) if pair[1] <= AS_GOOD * min(lefts))
    return asked_of_scale(told, left, rest, data)


def rescaled_output(
    data: DataSet,
    model: GreyBoxModel,
    simulator: Simulator,
    scores: Sequence[Score],
    values: Mapping[str, float],
) -> Asked | None:
    """The question for an output that the estimate does not follow while it follows others; else None.

    Start values that simulate badly tell nothing of a scale: the larger an output is read, the smaller their error is beside it. What the
    other outputs lead to does: in the estimate or, as that may bend to the output that is lost, in a refit that hardly counts it. Seen: a
    gyro in deg/s, read as rad/s, for which a spring of 420 N m/rad ended at 14.

    Args:
        scores: of the estimate.
        values: its parameters.
    """
    judged = held_out_scores(scores)
    fits = fits_by_output(judged)
    lost = {name for name, fit in fits.items() if not fit >= FOLLOWS}
    short, achieved = beginnings(data), mean_fit(judged)
    if short is None or not lost or len(lost) == len(fits) or not np.isfinite(achieved):
        return None
    of_one = [change for change in _changes(model) if len(change.read) == 1 and lost.issuperset(change.read)]
    if not of_one:
        return None
    found = []
    for told_by in (values, values_without(short, model, simulator, lost)):
        after = [fit_after(short, model, simulator, c, refitted=False, values=told_by) for c in of_one if told_by]
        if after and max(after) > achieved:
            best = of_one[int(np.argmax(after))]
            refits = (fit_after(short, model, simulator, best, values=begun) for begun in (None, told_by))
            found.append((max(max(after), *refits), best))
    if not found:
        return None
    reached, best = max(found, key=lambda one: one[0])
    left = 100.0 - as_it_is(short, model, simulator, achieved)
    return asked_of_scale(best, left, 100.0 - reached, data) if is_far_better(left, 100.0 - reached) else None


def asked_of_scale(change: Change, left: float, rest: float, data: DataSet, also: str = "") -> Asked:
    """The question whether a channel is read so.

    Args:
        left: what is missing to a mean fit of 100 % as it is.
        rest: the same after the change.
        also: what was refitted beside it, a clause.
    """
    as_it_is = f" instead of {digits(100.0 - left, 3)} %" if np.isfinite(left) else ""
    lead = f"{change.question}{also}"
    question = (
        f"{lead}, a short refit reaches a mean fit of {100.0 - rest:.3g} % on {judging(data)}{as_it_is}. "
        "If that is so, mend the scale, unit or file_unit on the card; if not, disregard this"
    )
    return Asked(question, 100.0 - rest, lead, frozenset(change.read))


def of_units(model: GreyBoxModel) -> Iterator[Change]:
    """Of the changes those by factors that two units of one quantity differ by, no decades."""
    known = (PER_MINUTE, DEGREES, TURNS_PER_MINUTE)
    factors = {*known, *(1.0 / factor for factor in known)}
    yield from (change for change in _changes(model) if change.factor in factors)


def _changes(model: GreyBoxModel) -> Iterator[Change]:
    for signals in (model.inputs, model.outputs):
        for signal in signals if len(signals) <= MOST_CHANNELS else ():
            of_encoder = signal in model.outputs and signal.unit.strip() in POSITIONS
            yield from _times([signal.name], [*_factors(signal.unit), *([QUADRATURE] if of_encoder else [])])
            yield from _of_other_zero(signal.name, signal.unit.strip())
    yield from _of_one_unit(model)


def _of_one_unit(model: GreyBoxModel) -> Iterator[Change]:
    """All channels of one unit, in another: who reads one angle in degrees as radians does so with all. Seen: a leg's hip and knee."""
    of_unit: dict[str, list[str]] = {}
    for signal in (*model.inputs, *model.outputs):
        of_unit.setdefault(signal.unit.strip(), []).append(signal.name)
    for unit, names in of_unit.items():
        if 1 < len(names) <= MOST_CHANNELS:
            yield from _times(names, [factor for factor in _factors(unit) if factor not in DECADES])


def _times(names: Sequence[str], factors: Sequence[float]) -> Iterator[Change]:
    """Each of the ``factors`` either way, for all channels of these names at once."""
    own = {name: name for name in names}
    for times in factors:
        yield Change(own, _question(listed(names), times, "as large"), times)
        yield Change(own, _question(listed(names), times, "smaller"), 1.0 / times)


def _of_other_zero(name: str, unit: str) -> Iterator[Change]:
    """A temperature in another unit than its own. Seen: a floor of 287 K read as degC, and a scale of 1 given to end the warning of it."""
    for other in TEMPERATURES if unit in (*TEMPERATURES, "°C", "°F") else ():
        factor, offset = conversion(other, unit, "")
        if offset:
            yield Change({name: name}, f"Is {name} recorded in {other}? Converted to {unit}", factor, more=offset)


def _factors(unit: str) -> list[float]:
    words = set(re.findall(r"[A-Za-z]+", unit))
    times = [PER_MINUTE] if words & {"s", "min", "h", "Hz", "rpm"} else []
    degrees = [DEGREES] if words & {"rad", "deg"} else []
    degrees += [BAR] if words & {"Pa", "bar"} else []
    if _ANGULAR_SPEED.fullmatch(unit.strip()) or per_minute(unit):
        # no refit tells 9.55 from 10, and of angular speeds rpm are the likelier slip
        return [TURNS_PER_MINUTE, *DECADES[1:], *times, *degrees]
    return [*DECADES, *times, *degrees]


def _question(name: str, times: float, size: str) -> str:
    known = {
        PER_MINUTE: " (s and min differ by that)",
        DEGREES: " (rad and deg differ by that)",
        TURNS_PER_MINUTE: " (rpm and rad/s differ by that)",
        BAR: " (Pa and bar differ by that)",
        QUADRATURE: " (an encoder counts four times for each of its lines)",
    }
    return f"Is the scale of {name} right? With values {digits(times, 3)} times {size}{known.get(times, '')}"
