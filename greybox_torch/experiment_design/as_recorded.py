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


def as_recorded(data: DataSet, names: Sequence[str], given: Mapping[str, Any]) -> tuple[str, ...]:
    """The inputs that are to be as recorded: those that are ``given`` so; and, where others were set in steps, those that change from
    sample to sample and have no range: measured, as a temperature outside is, rather than set.

    Args:
        names: of inputs that no loop drives and that moved in some recording.
    """
    asked = [n for n in names if given.get(n) == AS_RECORDED]
    open_ones = [n for n in names if n not in asked and not has_range(given.get(n))]
    steps = [n for n in open_ones if _set_in_steps(data, n)]
    measured = [n for n in open_ones if n not in steps] if steps else []
    return tuple(n for n in names if n in asked or n in measured)


def has_range(entry: Any) -> bool:
    """Whether the limits of a signal say from where to where it may go."""
    return isinstance(entry, Mapping) and not {"lower", "upper"}.isdisjoint(entry)


def _set_in_steps(data: DataSet, name: str) -> bool:
    """Whether most changes of a channel stand alone: one sample before and one after it keep their value."""
    changes = [np.diff(r.signals[name]) != 0.0 for r in data.recordings]
    alone = sum(int((c[1:-1] & ~c[:-2] & ~c[2:]).sum()) for c in changes)
    return alone > STEPPED * max(sum(int(c[1:-1].sum()) for c in changes), 1)


def traces_of(recording: Recording, names: Sequence[str]) -> dict[str, np.ndarray]:
    """The signals (N,) of a recording by name, straight lines across missing samples."""
    found, at = {}, np.arange(len(recording))
    for name in names:
        values = np.asarray(recording.signals[name], dtype=float)
        there = np.isfinite(values)
        found[name] = np.interp(at, at[there], values[there])
    return found


def continued(trace: np.ndarray, samples: int) -> np.ndarray:
    """So many ``samples`` of a trace (N,): beyond its end it runs backwards, then forwards again, without a jump."""
    last = len(trace) - 1
    return trace[last - np.abs(last - np.arange(samples) % (2 * last))] if last else np.repeat(trace, samples)
