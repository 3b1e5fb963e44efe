"""When fitted parameters say nothing about the machine: pure functions that mechanisms answer with.

Every function gives a clause in words, or None where there is nothing to object to.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from greybox_torch.mechanisms.surroundings import Surroundings
from greybox_torch.model import Parameter

AT_BOUND = 1e-6
"""Distance from a bound, in shares of the larger of the bound and the value, within which a parameter counts as there."""

LEAST_PERIODS = 2.0
"""Periods within the travel (or the record) that a law which repeats has to go through to be seen to repeat."""

WHOLE = 0.02
"""How near a whole number an order per turn has to be for its law to be one of a round machine (poles, slots, teeth): of curves that only
look like a wave, one in twenty-five comes so near by chance."""

LEAST_PERIODS_OF_WHOLE = 0.75
"""Periods within the travel that a law of such an order has to go through."""

LEAST_SAMPLES = 3.0
"""Samples that a time constant has to last to be seen."""

LONGEST = 2.0
"""Lengths of the longest record, beyond which a time constant is a slope and no more."""


def lost_in_its_deviation(
    names: Sequence[str], values: Mapping[str, float], deviations: Mapping[str, float]
) -> str | None:
    """Every amplitude of ``names`` is zero, or smaller than its standard deviation (or that is not a number): zero is as good.

    Of several amplitudes chance makes some larger: then the largest counts in as many deviations as their number lets expect.
    """
    stated = [name for name in names if name in values]
    if stated and all(values[name] == 0.0 for name in stated):
        return f"{' and '.join(stated)} = 0"
    known = [name for name in names if name in deviations]
    expected = np.sqrt(1.0 + 2.0 * np.log(max(len(known), 1)))
    if not known or any(abs(values[name]) > expected * deviations[name] for name in known):
        return None
    worst = max(known, key=lambda name: abs(values[name]))
    times = f"{expected:.2g} times " if len(known) > 1 else ""
    return f"{worst} = {values[worst]:.3g} is smaller than {times}its standard deviation {deviations[worst]:.3g}"


def at_a_bound(
    parameters: Sequence[Parameter], values: Mapping[str, float], natural: Collection[str] = ()
) -> str | None:
    """A free parameter sits at a bound that is neither zero nor ``natural`` (``NAME``, or ``NAME.lower``, ``NAME.upper``)."""
    for p in parameters:
        for side, bound in zip(("lower", "upper"), p.bounds, strict=True):
            allowed = p.fixed or not np.isfinite(bound) or bound == 0.0 or {p.name, f"{p.name}.{side}"} & set(natural)
            scale = max(abs(bound), abs(values[p.name]))
            if not allowed and abs(values[p.name] - bound) <= AT_BOUND * scale:
                return f"{p.name} = {values[p.name]:.3g} is at its {side} bound"
    return None


def beyond(name: str, value: float, around: Surroundings, signal: str) -> str | None:
    """A place lies where the ``signal`` never was."""
    if signal not in around.ranges or around.ranges[signal].low < value < around.ranges[signal].high:
        return None
    reached = f"{around.ranges[signal].low:.3g} to {_said(around.ranges[signal].high, around, signal)}"
    return f"{name} = {value:.3g} lies outside of where {signal} was, {reached}"


def longer_than_the_travel(name: str, value: float, around: Surroundings, signal: str) -> str | None:
    """A length is more than the ``signal`` moved from end to end."""
    if signal not in around.ranges or value <= around.ranges[signal].span:
        return None
    return (
        f"{name} = {value:.3g} is more than {signal} moved in all, {_said(around.ranges[signal].span, around, signal)}"
    )


def faster_than_it_went(name: str, value: float, around: Surroundings, signal: str = "speed") -> str | None:
    """A speed is above all that were recorded."""
    if signal not in around.ranges or value < around.ranges[signal].reach:
        return None
    return (
        f"{name} = {value:.3g} is above every recorded {signal}, {_said(around.ranges[signal].reach, around, signal)}"
    )


def not_a_time_of_the_record(name: str, seconds: float, around: Surroundings) -> str | None:
    """A time constant is shorter than a few samples, or far longer than the longest record."""
    if seconds < LEAST_SAMPLES * around.sample_time:
        return f"{name} = {seconds:.3g} s is shorter than {LEAST_SAMPLES:g} samples of {around.sample_time:.3g} s"
    return too_long(name, seconds, around)


def too_long(name: str, seconds: float, around: Surroundings) -> str | None:
    """A time constant is far longer than the longest record."""
    if "time" not in around.ranges or seconds <= LONGEST * around.ranges["time"].high:
        return None
    return f"{name} = {seconds:.3g} s is far longer than the longest record, {around.ranges['time'].high:.3g} s"


def periods(order: float, around: Surroundings) -> float:
    """How often what has an order per unit of position repeats in the travel."""
    return abs(order) * around.ranges["position"].span / (2 * np.pi)


def not_seen_to_repeat(order: float, around: Surroundings, once_per_turn: bool = False) -> str | None:
    """An order per turn goes through too few periods in the travel, or passes faster than sampling resolves at the usual speed.

    Args:
        once_per_turn: whether the law, once per turn, is one of a round machine, as friction is (a bent shaft) and a torque, which a weight
            is as well, is not.
    """
    if "position" in around.ranges:
        times = periods(order, around)
        least = LEAST_PERIODS_OF_WHOLE if _whole_per_turn(order, around, once_per_turn) else LEAST_PERIODS
        if times < least:
            return (
                f"order = {order:.3g} repeats {times:.2g} times in the travel; {least:g} are needed to see that it does"
            )
    if "speed" in around.ranges:
        samples = 2 * np.pi / max(abs(order) * around.ranges["speed"].rms * around.sample_time, 1e-300)
        if samples < 2.0:
            return f"order = {order:.3g} leaves {samples:.2g} samples a period at the usual speed; 2 are the least that sampling resolves"
    return None


def _whole_per_turn(order: float, around: Surroundings, once: bool) -> bool:
    """Whether an order is a whole number of periods per turn, or ``once``."""
    least = 0.5 if once else 1.5
    return is_angle(around) and abs(order) > least and abs(order - round(order)) < WHOLE


def is_angle(around: Surroundings) -> bool:
    """Whether positions are angles, as far as the model says: those of no known unit are."""
    return around.units.get("position", "") in ("rad", "")


def not_a_frequency_of_the_record(name: str, omega: float, around: Surroundings) -> str | None:
    """An angular frequency in rad/s goes through too few periods in the record, or lies above what sampling resolves."""
    if omega * around.sample_time >= np.pi:
        return f"{name} = {omega:.3g} rad/s is above the Nyquist frequency, {np.pi / around.sample_time:.3g} rad/s"
    if "time" in around.ranges and (periods := omega * around.ranges["time"].high / (2 * np.pi)) < LEAST_PERIODS:
        return (
            f"{name} = {omega:.3g} rad/s swings {periods:.2g} times in the longest record; {LEAST_PERIODS:g} are needed"
        )
    return None


def _said(value: float, around: Surroundings, signal: str) -> str:
    return f"{value:.3g} {around.units.get(signal, '')}".rstrip()
