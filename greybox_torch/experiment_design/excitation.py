"""Inputs by a few numbers each: multisines, steps, chirps, and slow reversals, around an operating point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.experiment_design.limits import Range

KINDS = ("multisine", "steps", "chirp", "reversals")
LINES = 16
"""Sines of a multisine."""
RAMP = 0.5
"""Share of a step's length that it may ramp for, where the rate is limited."""


@dataclass(frozen=True)
class Excitation:
    """One input signal.

    ``slow`` and ``fast`` in Hz are its lowest and highest frequency (steps last half a period of a frequency between them, reversals have
    the slow one). ``centre`` is where in the input's range it lies, from -1 to 1, ``amplitude`` which share of what is left there it
    takes, ``seed`` draws phases and levels.
    """

    kind: str
    slow: float
    fast: float
    centre: float
    amplitude: float
    seed: int

    def sampled(self, time: np.ndarray, within: Range) -> np.ndarray:
        """The input (N,) at times (N,) in s, within its range and its rate.

        A signal that would change faster than the rate allows is made smaller, not slower.
        """
        shape = _SHAPES[self.kind](self, time)
        size = self.amplitude * (1.0 - abs(self.centre)) * within.half
        steepest = float(np.abs(np.diff(shape) / np.diff(time)).max(initial=0.0))
        if np.isfinite(within.rate) and size * steepest > within.rate:
            size = within.rate / steepest
        return np.clip(within.middle + self.centre * within.half + size * shape, within.lower, within.upper)

    def smaller(self, factor: float) -> Excitation:
        """The same around the same operating point, with an amplitude smaller by a factor."""
        return Excitation(self.kind, self.slow, self.fast, self.centre, factor * self.amplitude, self.seed)


def _multisine(own: Excitation, time: np.ndarray) -> np.ndarray:
    rng = np.random.default_rng(own.seed)
    lines = np.geomspace(own.slow, max(own.fast, own.slow), LINES)
    phases = rng.uniform(0, 2 * np.pi, LINES)
    total = np.sin(2 * np.pi * lines[:, None] * time + phases[:, None]).sum(axis=0)
    return total / np.abs(total).max()


def _chirp(own: Excitation, time: np.ndarray) -> np.ndarray:
    span = max(float(time[-1] - time[0]), 1e-300)
    ratio = max(own.fast / own.slow, 1.0 + 1e-9)
    passed = (time - time[0]) / span
    return np.sin(2 * np.pi * own.slow * span / np.log(ratio) * (ratio**passed - 1.0))


def _steps(own: Excitation, time: np.ndarray) -> np.ndarray:
    """Levels drawn at random, each held for between half a fast and half a slow period, with ramps between them."""
    rng = np.random.default_rng(own.seed)
    corners, levels, at = [float(time[0])], [0.0], float(time[0])
    while at < time[-1]:
        held = 0.5 / np.exp(rng.uniform(np.log(own.slow), np.log(max(own.fast, own.slow))))
        level = float(rng.uniform(-1.0, 1.0))
        corners += [at + RAMP * held, at + held]
        levels += [level, level]
        at += held
    return np.interp(time, corners, levels)


def _reversals(own: Excitation, time: np.ndarray) -> np.ndarray:
    """A triangle."""
    turns = own.slow * (time - time[0])
    return 1.0 - 4.0 * np.abs((turns + 0.75) % 1.0 - 0.5)


_SHAPES = {"multisine": _multisine, "steps": _steps, "chirp": _chirp, "reversals": _reversals}


def drawn(rng: np.random.Generator, slowest: float, fastest: float) -> Excitation:
    """One at random between two frequencies in Hz."""
    ends = np.sort(np.exp(rng.uniform(np.log(slowest), np.log(fastest), 2)))
    centre = float(rng.uniform(-0.8, 0.8)) * float(rng.integers(0, 2))
    return Excitation(
        str(rng.choice(KINDS)),
        float(ends[0]),
        float(ends[1]),
        centre,
        float(np.sqrt(rng.uniform(0.05, 1.0))),
        int(rng.integers(2**31)),
    )


def varied(own: Excitation, rng: np.random.Generator, slowest: float, fastest: float) -> Excitation:
    """One like it: frequencies, operating point and amplitude moved a little, phases and levels mostly kept."""
    ends = np.sort(np.clip(np.array([own.slow, own.fast]) * np.exp(0.35 * rng.normal(size=2)), slowest, fastest))
    return Excitation(
        own.kind,
        float(ends[0]),
        float(ends[1]),
        float(np.clip(own.centre + 0.15 * rng.normal(), -0.9, 0.9)),
        float(np.clip(own.amplitude * np.exp(0.2 * rng.normal()), 0.02, 1.0)),
        own.seed if rng.uniform() < 0.7 else int(rng.integers(2**31)),
    )
