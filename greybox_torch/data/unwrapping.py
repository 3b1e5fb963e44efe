"""Encoders that begin anew after every turn: how they are known, and what they show with the turns added up."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

TURNS = {"rad": 2.0 * math.pi, "mrad": 2000.0 * math.pi, "deg": 360.0, "°": 360.0, "rev": 1.0, "turn": 1.0, "": 0.0}
"""A turn in units of angle. What has no unit may be an angle in degrees or radians, or counts."""
_COUNTS = (3600, 36000, *(2**n for n in range(8, 33)))
"""Counts of a turn; a channel of whole numbers may have any unit, as where counts were taken for radians."""
_NEARLY = 0.9
"""Share of a turn that the channel's range is at least."""
_FASTEST = 0.25
"""Share of a turn that a channel moves in one sample at most, the turns added up; a jump is more than half a turn."""
_PLACES = 10
"""Equal parts of the range, in each of which there are samples: a switch jumps as far, and is never in between."""
_OVERFLOWS = 16
"""Up to two to this many turns a counter goes through before it overflows, as one of 16 bits at 4096 counts a turn goes through 16."""
_AT_THE_ENDS, _STEPS_THERE, _DIFFERENT = 0.98, 0.02, 20
"""Of counts that stay near both ends: share of the turn that they span, share that they move in a sample, and how many values differ."""


def unwrapped(values: Any, period: float) -> NDArray[np.float64]:
    """Samples (N,) with as many periods added to each that no step is more than half of one; missing ones stay missing.

    The first known sample stays as it is, and steps across missing ones are judged like any other.
    """
    found = np.array(values, dtype=np.float64)
    if found.ndim:
        known = ~np.isnan(found)
        found[known] = np.unwrap(found[known], period=float(period))
    return found


def turn_within(values: NDArray[np.float64], unit: str) -> tuple[float, NDArray[np.intp]]:
    """The turn by which values (N,), none of them missing, jump again and again, in their ``unit``, and the samples (K,) that jumps follow.

    Zero, and no samples, where they do not.
    """
    return _within(values, _turns(values, unit))


def several_turns_within(values: NDArray[np.float64], unit: str) -> tuple[float, NDArray[np.intp]]:
    """The same of two, four, eight ... turns, by which an angle (N,) jumps where a counter of turns overflows."""
    return _within(values, [TURNS[unit] * 2**n for n in range(1, _OVERFLOWS + 1)] if TURNS.get(unit) else [])


def _within(values: NDArray[np.float64], possible: list[float]) -> tuple[float, NDArray[np.intp]]:
    extent = float(np.ptp(values)) if len(values) > _PLACES else 0.0
    turns = [turn for turn in possible if _NEARLY * turn < extent <= turn * (1.0 + 1e-6)]
    for turn in turns:
        steps = np.diff(values)
        jumps = np.flatnonzero(np.abs(steps) > 0.5 * turn)
        moved = np.abs(steps - turn * np.rint(steps / turn))
        between = np.histogram(values, _PLACES)[0].all()
        fastest = _FASTEST if between else _STEPS_THERE if _at_the_ends(values, extent, turn) else -1.0
        if len(jumps) and moved.max() <= fastest * turn:
            return turn, jumps
    return 0.0, np.empty(0, dtype=np.intp)


def _at_the_ends(values: NDArray[np.float64], extent: float, turn: float) -> bool:
    """Whether counts are at the two ends of a turn only, as those of a small motion to both sides of zero."""
    return turn >= min(_COUNTS) and extent > _AT_THE_ENDS * turn and len(np.unique(values)) >= _DIFFERENT


def _turns(values: NDArray[np.float64], unit: str) -> list[float]:
    """What a turn may be."""
    angles = list(dict.fromkeys([TURNS[unit], 2.0 * math.pi, 360.0])) if unit in TURNS else []
    counts = _COUNTS if np.array_equal(values, np.rint(values)) else ()
    return [turn for turn in (*angles, *map(float, counts)) if turn]
