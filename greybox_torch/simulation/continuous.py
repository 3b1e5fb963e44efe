"""The free run of long records in parallel: windows side by side, their start states iterated until the trajectory is continuous.

A free run is sequential in time, so that one record alone would occupy a single lane of the machine. Cut into windows it occupies
all; what is to be found are the states at which the windows begin. Newton's method on the gaps between them, with the transition
matrices of the windows, needs a few passes from rough guesses and one or two near a known trajectory.

Source: P. Deuflhard, "Newton Methods for Nonlinear Problems", 2004, ch. 2 (simplified Newton); U. Ascher, R. Mattheij and R. Russell,
"Numerical Solution of Boundary Value Problems", 1995, ch. 4 (multiple shooting as marching).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import Windows

WINDOWS = 64
"""Into how many windows all experiments together are cut: enough to fill the lanes of several cores evenly."""

CLOSED = 1e-11
"""Gap, relative to a state's size, that a correction may leave."""

SWEEPS = 15
"""Passes after which a trajectory that is not continuous is run sequentially."""


@dataclass(frozen=True)
class Chain:
    """Windows of one length that follow one another through every experiment.

    ``order`` (E, C) holds the window index of the c-th window of each experiment, −1 beyond its last. All windows of an experiment but
    the last are of exactly ``windows.steps`` samples, so that the end of one is the start of the next.
    """

    windows: Windows
    order: np.ndarray

    @cached_property
    def links(self) -> list[tuple[np.ndarray, np.ndarray]] | list[tuple[slice, slice]]:
        """By position, indices of the windows there and of those that follow them, where one follows."""
        if len(self.order) == 1:  # slices: what they pick out is not copied, and most runs are of one experiment
            count = self.order.shape[1]
            return [(slice(k, k + 1), slice(k + 1, k + 2)) for k in range(count - 1)]
        pairs = zip(self.order.T[:-1], self.order.T[1:], strict=True)
        return [(now[following >= 0], following[following >= 0]) for now, following in pairs]

    @property
    def experiment(self) -> np.ndarray:
        """The experiment (W,) of every window."""
        result = np.empty(len(self.windows.start), dtype=np.int64)
        for e, row in enumerate(self.order):
            result[row[row >= 0]] = e
        return result


@dataclass(frozen=True)
class Trajectory:
    """A continuous trajectory: window start states (W, n_x), and the derivative (W, n_x, n_t) of each window's end by its start.

    The first n_t states are those that act on the outputs, directly or through one another. The others are not made continuous.
    """

    starts: np.ndarray
    transitions: np.ndarray


def chain(records: Records, *, count: int = WINDOWS, shortest: int = 8) -> Chain:
    """All experiments of ``records`` cut into at most about ``count`` windows of one length."""
    lengths = records.lengths
    length = max(shortest, int(np.ceil(lengths.sum() / max(count, len(lengths)))))
    while length < lengths.max() and np.ceil(lengths / length).sum() > max(count, len(lengths)):
        length += 1
    numbers = np.ceil(lengths / length).astype(np.int64)
    order = np.full((len(lengths), int(numbers.max())), -1, dtype=np.int64)
    starts: list[np.ndarray] = []
    lasts: list[np.ndarray] = []
    for e, number in enumerate(numbers):
        order[e, :number] = np.arange(number) + sum(map(len, starts))
        starts.append(records.first[e] + length * np.arange(number))
        lasts.append(np.minimum(starts[-1] + length, records.last[e]))  # one beyond: its input ends the last step
    return Chain(Windows(np.concatenate(starts), np.concatenate(lasts), length), order)


def continuous(
    simulator: Simulator,
    records: Records,
    links: Chain,
    p: np.ndarray,
    x0: np.ndarray,
    *,
    guess: np.ndarray,
    transitions: np.ndarray | None = None,
) -> Trajectory | None:
    """The trajectory that begins at ``x0`` (E, n_x), with window starts iterated from ``guess`` (W, n_x).

    Args:
        transitions: of a trajectory nearby, which serve as long as the gaps shrink quickly with them.

    Returns:
        None where the iteration does not contract, or the simulation is not finite: run it sequentially, see
        :func:`sequential_starts`.
    """
    starts = guess.copy()
    starts[links.order[:, 0]] = x0
    before = np.inf
    for _ in range(SWEEPS):
        fresh = transitions is None
        directions = np.broadcast_to(np.eye(x0.shape[1]), (len(starts), x0.shape[1], x0.shape[1])) if fresh else None
        run = simulator.run(records, Pass(links.windows, p, starts, start_directions=directions))
        if fresh:
            assert run.dx_end is not None
            transitions = np.array(run.dx_end)
        assert transitions is not None
        acting = transitions.shape[2]
        gaps = _gaps(links, starts[:, :acting], run.x_end[:, :acting])
        with np.errstate(all="ignore"):
            largest = _relative(gaps, starts[:, :acting])
            starts[:, :acting] += _corrections(links, transitions, gaps)
        if not np.isfinite(largest) or not np.isfinite(starts).all():
            return None
        rate = min(1.0, largest / before) if before < np.inf else 1.0
        if rate * largest < CLOSED:
            return Trajectory(starts, transitions)
        slow = rate > 0.1 and before < np.inf
        if fresh and largest > before:
            return None
        transitions = None if slow else transitions
        before = largest
    return None


def sequential_starts(
    simulator: Simulator, records: Records, links: Chain, p: np.ndarray, x0: np.ndarray
) -> np.ndarray:
    """Window start states (W, n_x) of the trajectory from ``x0`` (E, n_x), one window after another; not finite where it overflows."""
    windows = links.windows
    starts = np.empty((len(windows.start), x0.shape[1]))
    starts[links.order[:, 0]] = x0
    for now, following in links.links:
        part = Windows(windows.start[now], windows.last[now], windows.steps)
        starts[following] = simulator.run(records, Pass(part, p, starts[now])).x_end
    return starts


def propagated(links: Chain, first: np.ndarray, own: np.ndarray, transitions: np.ndarray) -> np.ndarray:
    """Derivatives (W, n_d, n_x) of the window starts of a continuous trajectory by n_d unknowns.

    Args:
        first: of the experiments' start states, (E, n_d, n_x).
        own: of every window's end at a fixed start, (W, n_d, n_t).
        transitions: of every window's end by its start, (W, n_x, n_t), row by row the direction of the start.
    """
    result = np.zeros((*own.shape[:2], first.shape[2]))
    result[links.order[:, 0]] = first
    for now, following in links.links:
        result[following, :, : own.shape[2]] = own[now] + result[now] @ transitions[now]
    return result


def _gaps(links: Chain, starts: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """By how much (W, n_t) the window before ends beyond the start of each; zero for the first ones."""
    gaps = np.zeros_like(starts)
    before, after = links.order[:, :-1], links.order[:, 1:]
    linked = after >= 0
    gaps[after[linked]] = ends[before[linked]] - starts[after[linked]]
    return gaps


def _relative(gaps: np.ndarray, starts: np.ndarray) -> float:
    """The largest gap in units of its state's largest size."""
    size = np.abs(starts).max(axis=0)
    return float((np.abs(gaps).max(axis=0) / np.where(size > 0, size, 1.0)).max())


def _corrections(links: Chain, transitions: np.ndarray, gaps: np.ndarray) -> np.ndarray:
    """Newton's step (W, n_t) of the window starts: δ of the next = Φ δ + gap."""
    steps, acting = np.zeros_like(gaps), gaps.shape[1]
    for now, following in links.links:
        steps[following] = gaps[following] + (steps[now, None, :] @ transitions[now, :acting])[:, 0]
    return steps


__all__ = ["Chain", "Trajectory", "chain", "continuous", "propagated", "sequential_starts"]
