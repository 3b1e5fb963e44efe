"""Gaps in time stamps: the logger wrote nothing for a while, and nobody knows what drove the machine then."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.checks import FEWEST_SAMPLES
from greybox_torch.data.summer_time import clock_set_forward, written_date

SAMPLES_LOST = 5
"""Samples that may be missing one after the other before that is a gap, for which an experiment has to be split."""

_SOME = 0.05
"""Share of the steps up to which those over lost samples are told, which are multiples of the usual one with usual ones around them."""

_WHOLE = 0.25
"""Of a step: how far a longer one may lie from several usual ones where samples were lost; what is late otherwise lies anywhere."""

_BESIDE = 0.5
"""Of a step: how far those before and after may be from a usual one. Late samples are followed by short steps, or come several at once."""

_FEW = 0.01
"""Share of the steps up to which long ones are gaps. Where more are long, the logger writes whenever something changes."""


@dataclass(frozen=True)
class Gap:
    """The longest gap of a recording: ``seconds`` without a sample after sample ``after``, which was at ``begin`` and is followed by one
    at ``end`` (s). ``count`` gaps in all; ``step`` is the usual time between samples. ``start`` is when the experiment began: stamps
    may be dates, of which seconds since 1970 tell nobody a place.
    """

    after: int
    begin: float
    end: float
    step: float
    count: int
    start: float = 0.0

    @property
    def seconds(self) -> float:
        return self.end - self.begin

    def __str__(self) -> str:
        return f"{self._when} (after sample {self.after}, the first is 0; usual step {self.step:.4g} s){self._others}"

    @property
    def of_summer_time(self) -> bool:
        """Whether it is the only one and local time was set forward there, so that likely nothing is missing."""
        return self.count == 1 and clock_set_forward(self.begin, self.end, self.step)

    @property
    def in_brief(self) -> str:
        """For where the place in the file is told already."""
        return f"{self._when}{self._others}"

    @property
    def _when(self) -> str:
        begin, end = self.begin - self.start, self.end - self.start
        return f"gap in the time stamps: no sample for {self.seconds:.4g} s, from {begin:.6g} to {end:.6g} s after the start{self._dates}"

    @property
    def _dates(self) -> str:
        begin, end = written_date(self.begin), written_date(self.end)
        return f" ({begin} to {end}; UTC where the stamps have a time zone)" if begin and end else ""

    @property
    def _others(self) -> str:
        return f", the longest of {self.count} gaps" if self.count > 1 else ""


@dataclass(frozen=True)
class Lost:
    """``count`` samples that are missing after sample ``after``, ``seconds`` after the start: fewer than make a gap."""

    after: int
    seconds: float
    count: int


def lost_samples(time: NDArray[np.float64]) -> tuple[Lost, ...]:
    """Where single samples of increasing time stamps (N,), in s, are missing, up to :data:`SAMPLES_LOST` in one place."""
    steps = np.diff(time)
    if len(steps) < 3:
        return ()
    ratio = steps / np.median(steps)
    long = ratio > 1.5
    if long.sum() > max(1.0, _SOME * len(steps)):
        return ()
    usual = np.abs(ratio - 1.0) < _BESIDE
    count = np.rint(ratio).astype(np.int64) - 1
    lost = long & ~gap_steps(time) & (count <= SAMPLES_LOST) & (np.abs(ratio - 1.0 - count) <= _WHOLE)
    lost[1:-1] &= usual[:-2] & usual[2:]
    lost[[0, -1]] = False
    return tuple(Lost(int(k), float(time[k] - time[0]), int(count[k])) for k in np.flatnonzero(lost))


def longest_gap(time: NDArray[np.float64]) -> Gap | None:
    """The longest gap of increasing time stamps (N,), in s; None where there is none, or where long steps are the rule."""
    gaps = gap_steps(time)
    if not gaps.any():
        return None
    steps = np.diff(time)
    k = int(np.argmax(steps))
    return Gap(k, float(time[k]), float(time[k + 1]), float(np.median(steps)), int(gaps.sum()), float(time[0]))


def without_gaps(time: NDArray[np.float64]) -> NDArray[np.float64]:
    """The steps (K,) of time stamps that are not gaps."""
    return np.diff(time)[~gap_steps(time)]


def in_gaps(times: NDArray[np.float64], stamps: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which of other times (N,) lie in gaps of increasing stamps (K,); a time that is a stamp lies in none."""
    gaps = gap_steps(stamps)
    if not gaps.any():
        return np.zeros(len(times), dtype=bool)
    before = np.searchsorted(stamps, times, side="right") - 1
    inside = (before >= 0) & (before < len(gaps))
    k = np.where(inside, before, 0)
    return inside & gaps[k] & (stamps[k] != times)


def pieces_around(lost: tuple[int, int], rows: tuple[int, int]) -> str:
    """What to write on a card for an experiment with the rows [start, stop) to leave out the lost ones [first, end)."""
    around = ((rows[0], lost[0]), (lost[1], rows[1]))
    pieces = [f"rows = [{start}, {stop}]" for start, stop in around if stop - start >= FEWEST_SAMPLES]
    if len(pieces) == 2:
        return "two experiments in place of this one: " + " and ".join(pieces)
    return pieces[0] if pieces else "a file without gaps"


def gap_steps(time: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which steps (N - 1,) of increasing time stamps are gaps: none where long steps are the rule. The hour that local time leaves out is
    one, of however few samples.
    """
    steps = np.diff(time)
    if not len(steps):
        return np.zeros(0, dtype=bool)
    step = float(np.median(steps))
    long = steps > (SAMPLES_LOST + 1.5) * step
    longest = int(np.argmax(steps))
    long[longest] |= not long.any() and clock_set_forward(float(time[longest]), float(time[longest + 1]), step)
    return long & (long.sum() <= max(1.0, _FEW * len(steps)))
