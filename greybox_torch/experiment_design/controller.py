"""The controller that a machine runs under: digital loops, of many machines at a time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Memory:
    """What a loop keeps from sample to sample, for each of C machines.

    ``total`` (C,) is the integral of the error times ``integral``, ``before`` (C,) the output one sample ago (None where there is none),
    ``waiting`` the inputs (C,) that are still to act, the next one first.
    """

    total: np.ndarray
    before: np.ndarray | None
    waiting: tuple[np.ndarray, ...]


@dataclass(frozen=True)
class Loop:
    """A digital PID that drives one input by one output.

    ``driven`` and ``measured`` are their indices in the model, ``lower`` and ``upper`` the limits of the input, ``step`` the sample time
    in s; the rest is as on the card (:class:`greybox_torch.data.card_controller.LoopEntry`).
    """

    driven: int
    measured: int
    lower: float
    upper: float
    step: float
    gain: float
    integral: float = 0.0
    derivative: float = 0.0
    offset: float = 0.0
    delay: int = 0

    @property
    def rest(self) -> float:
        """The input where there is no error, and until the first answer acts."""
        return min(max(self.offset, self.lower), self.upper)

    def begun(self, count: int) -> Memory:
        """The memory of so many machines before the first sample: no error so far."""
        return Memory(np.zeros(count), None, (np.full(count, self.rest),) * self.delay)

    def answer(self, memory: Memory, reference: np.ndarray, measured: np.ndarray) -> tuple[np.ndarray, Memory]:
        """The inputs (C,) that act from one sample on, by its set point (C,) and output (C,), and the memory after it.

        While an input is clipped, the integral does not go on in that direction (anti-windup). No number where the output is none.
        """
        error, total = reference - measured, memory.total
        free = self.offset + self.gain * (error + total)
        if self.derivative > 0.0 and memory.before is not None:
            free = free - self.gain * self.derivative / self.step * (measured - memory.before)
        found = np.minimum(np.maximum(free, self.lower), self.upper)
        if self.integral > 0.0:
            push = self.gain * error
            beyond = ((free > self.upper) & (push > 0.0)) | ((free < self.lower) & (push < 0.0))
            total = np.where(beyond, total, total + self.integral * self.step * error)
        acting, *waiting = *memory.waiting, found
        return acting, Memory(total, measured, tuple(waiting))
