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
    """Whether most changes of a channel stand alone: one sample before and one after it keep their value."""
    changes = [np.diff(r.signals[name]) != 0.0 for r in data.recordings]
    alone = sum(int((c[1:-1] & ~c[:-2] & ~c[2:]).sum()) for c in changes)
    return alone > STEPPED * max(sum(int(c[1:-1].sum()) for c in changes), 1)


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
