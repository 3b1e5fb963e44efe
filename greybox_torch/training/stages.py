"""The curriculum: windows from short to long, which of them are held out, and their start states."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.errors import UserError
from greybox_torch.estimate.levenberg_marquardt import Settings
from greybox_torch.estimate.overflow import overflow_error
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.window_fit import WindowFit, fit_windows
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import Windows, cut
from greybox_torch.training.gradients import Batch
from greybox_torch.training.settings import TrainingSettings

SHORTEST = 20
"""Samples of a window at the least."""

START_SETTINGS = Settings(iterations=8, tolerance=1e-3, trials=5)


@dataclass(frozen=True)
class Stage:
    """Windows of one length: their start states (W, n_x), which are held out (W,), and the records on which warm-up samples are NaN."""

    windows: Windows
    starts: np.ndarray
    held_out: np.ndarray
    records: Records

    def batch(self, chosen: np.ndarray) -> Batch:
        """Some of the windows, by their index."""
        start, last = self.windows.start[chosen], self.windows.last[chosen]
        return Batch(self.records, Windows(start, last, int((last - start).max()) + 1), self.starts[chosen])

    def batches(self, size: int, order: np.random.Generator) -> Iterator[Batch]:
        """All windows that are not held out, in mini-batches of about ``size``."""
        chosen = order.permutation(np.flatnonzero(~self.held_out))
        for part in np.array_split(chosen, max(1, round(len(chosen) / size))):
            yield self.batch(np.sort(part))

    @property
    def held_out_batch(self) -> Batch:
        return self.batch(np.flatnonzero(self.held_out))

    @property
    def training_batch(self) -> Batch:
        return self.batch(np.flatnonzero(~self.held_out))


def window_lengths(records: Records, settings: TrainingSettings) -> list[int]:
    """The lengths of the curriculum, in samples.

    Raises:
        UserError: the records are too short to hold some of them out.
    """
    longest = int(records.lengths.max())
    unit = max(SHORTEST, round(longest / 64))
    lengths = [unit * factor for factor in settings.factors if unit * factor <= longest // 4]
    if not lengths:
        raise UserError(
            f'training needs an experiment of role "estimation" with at least {4 * SHORTEST * settings.factors[0]} samples, to learn on '
            f"some stretches and hold out others; the longest has {longest}"
        )
    return lengths


def held_out_samples(records: Records, longest: int, settings: TrainingSettings) -> np.ndarray:
    """Which samples (N,) of the records no step is taken on: stretches of ``longest`` samples, drawn with the seed.

    None begins an experiment: what is measured behind it hardly determines the start states, and a free run from any others says nothing of
    the model. Seen: a building zone of rms 1.5 °C, of which the physics alone "ran away" by 280 °C. One that begins none is left to learn
    on, if there is a second, or nothing late in an experiment would ever be seen.
    """
    windows = cut(records, longest)
    count, begins = len(windows.start), np.isin(windows.start, records.first)
    draw = np.random.default_rng([settings.seed, 1])
    chosen = draw.choice(count, min(max(1, round(settings.held_out * count)), count - 1), replace=False)
    most = max(1, int((~begins).sum()) - 1)
    kept = chosen[~begins[chosen]][:most]
    others = np.setdiff1d(np.flatnonzero(~begins), kept)
    further = draw.choice(others, min(len(chosen), most, len(kept) + len(others)) - len(kept), replace=False)
    chosen = np.concatenate([kept, further])
    mask = np.zeros(records.y.shape[1], dtype=bool)
    for k in chosen:
        mask[windows.start[k] : windows.last[k] + 1] = True
    return mask


def without_samples(problem: Problem, mask: np.ndarray) -> Problem:
    """``problem`` with the measurement missing where ``mask`` (N,) says so."""
    return replace(problem, records=replace(problem.records, y=np.where(mask, np.nan, problem.records.y)))


def stage(problem: Problem, length: int, starts: np.ndarray, mask: np.ndarray, warm_up: float) -> Stage:
    """The windows of ``length`` samples of a problem with start states (W, n_x)."""
    windows = cut(problem.records, length)
    ahead = round(warm_up * length)
    y = problem.records.y.copy()
    for first in windows.start:
        y[:, first : first + ahead] = np.nan
    return Stage(windows, starts, mask[windows.start], replace(problem.records, y=y))


def fitted_starts(
    problem: Problem,
    simulator: Simulator,
    length: int,
    *,
    starts: np.ndarray | None = None,
    shorter: tuple[int, np.ndarray] | None = None,
) -> np.ndarray:
    """Start states (W, n_x) of the windows of ``length`` samples that fit the measurement best, with the parameters as they are.

    Args:
        starts: to begin with.
        shorter: instead of them, the length and the start states of shorter windows.

    Raises:
        NumericalError: even windows of this length overflow.
    """
    fixed = problem.fixed
    before = None
    if shorter is not None:
        windows = cut(problem.records, shorter[0])
        before = WindowFit(fixed, windows, shorter[1], 0.0, np.zeros(len(windows.start)), 0)
    found = fit_windows(fixed, simulator, length, starts=starts, shorter=before, settings=START_SETTINGS)
    if found is None:
        raise overflow_error("training", problem, simulator)
    return found.starts
