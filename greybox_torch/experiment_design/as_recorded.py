"""Inputs that a next recording has as an earlier one had them: weather, loads, what nobody sets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from greybox_torch.data import DataSet, Recording

AS_RECORDED = "recorded"
"""What the limits say of an input that is to be as it was recorded."""

STEPPED = 0.5
"""Share of an input's changes that stand alone, the input constant before and after, from which on it was set in steps."""

BEYOND_NOISE = 8.0
"""Times the median change from a sample to the next, which is noise where a value is held, that a change is more than noise: five standard
deviations of it."""

BEYOND_ROUNDING = 8.0
"""Steps of a floating-point number of the input's size that a change is more than rounding: where most samples are exactly as the last,
the median change is zero, and a last digit is no step."""

MOST_BETWEEN = 0.1
"""Part of its own standard deviation by which an input may vary between the steps that it is set in."""

ROUNDING = 1e-6
"""Share of a step by which time stamps may be off by rounding alone."""


def as_recorded(
    data: DataSet, names: Sequence[str], given: Mapping[str, Any], *, driven: bool = False
) -> tuple[str, ...]:
    """The inputs that are to be as recorded: those that are ``given`` so; and, where others are known to be set, those that change from
    sample to sample and have no range: measured, as a temperature outside is, rather than set. An input is known to be set that was set in
    steps, that is given a range, or that a loop drives.

    Args:
        names: of inputs that no loop drives and that moved in some recording.
        driven: whether a loop drives another input.
    """
    asked = [n for n in names if given.get(n) == AS_RECORDED]
    limited = [n for n in names if has_range(given.get(n))]
    steps = [n for n in names if n not in (*asked, *limited) and _set_in_steps(data, n)]
    measured = [n for n in names if n not in (*limited, *steps)] if driven or limited or steps else []
    return tuple(n for n in names if n in asked or n in measured)


def has_range(entry: Any) -> bool:
    """Whether the limits of a signal say from where to where it may go."""
    return isinstance(entry, Mapping) and not {"lower", "upper"}.isdisjoint(entry)


def _set_in_steps(data: DataSet, name: str) -> bool:
    """Whether most changes of a channel stand alone, one sample before and one after it keeping their value, and it keeps its value between
    the changes, over all recordings together: in one it may rest.

    A value that is read back has noise. Seen: a heater's power, set every 20 min, each sample of which differed from the last by 0.02 kW,
    told as "never set in steps".
    """
    traces = [_finite(r.signals[name]) for r in data.recordings]
    changes = [_changed(values) for values in traces]
    alone = sum(int((c[1:-1] & ~c[:-2] & ~c[2:]).sum()) for c in changes)
    if alone <= STEPPED * max(sum(int(c[1:-1].sum()) for c in changes), 1):
        return False
    between = np.concatenate([_between_changes(*one) for one in zip(traces, changes, strict=True)])
    return bool(np.sqrt(np.mean(between**2)) <= MOST_BETWEEN * np.std(np.concatenate(traces)))


def _finite(values: np.ndarray) -> np.ndarray:
    values = np.asarray(values, dtype=float)
    return values[np.isfinite(values)]


def _changed(values: np.ndarray) -> np.ndarray:
    """From which of the samples (N,) to the next they change by more than noise, (N - 1,)."""
    if len(values) < 2:
        return np.zeros(0, dtype=bool)
    changes = np.abs(np.diff(values))
    rounding = BEYOND_ROUNDING * np.spacing(np.abs(values).max())
    return changes > max(BEYOND_NOISE * float(np.median(changes)), rounding)


def _between_changes(values: np.ndarray, changed: np.ndarray) -> np.ndarray:
    """The samples (N,) less the mean of those between the same two changes (N - 1,)."""
    step = np.concatenate([[0], np.cumsum(changed)])[: len(values)]
    return values - (np.bincount(step, values) / np.bincount(step))[step] if len(values) else values


def traces_of(recording: Recording, names: Sequence[str], step: float) -> dict[str, np.ndarray]:
    """The signals of a recording by name, (N,) samples that are ``step`` s apart, straight lines across missing samples and gaps."""
    at = (recording.time - recording.time[0]) / step
    # rounded time stamps are those of the samples themselves
    at = np.where(np.abs(at - np.round(at)) < ROUNDING, np.round(at), at)
    found, wanted = {}, np.arange(int(at[-1]) + 1)
    for name in names:
        values = np.asarray(recording.signals[name], dtype=float)
        there = np.isfinite(values)
        found[name] = np.interp(wanted, at[there], values[there])
    return found


def continued(trace: np.ndarray, samples: int) -> np.ndarray:
    """So many ``samples`` of a trace (N,): beyond its end it runs backwards, then forwards again, without a jump."""
    last = len(trace) - 1
    return trace[last - np.abs(last - np.arange(samples) % (2 * last))] if last else np.repeat(trace, samples)
