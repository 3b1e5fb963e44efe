"""Adam on mini-batches of windows, one window length after the other, stopped early on held-out windows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from greybox_torch.errors import NumericalError
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.training.adam import Adam, learning_rate
from greybox_torch.training.gradients import Batch, SequenceGradient
from greybox_torch.training.settings import TrainingSettings
from greybox_torch.training.stages import Stage, fitted_starts, stage
from greybox_torch.training.state import Epoch, TrainingState
from greybox_torch.training.unknowns import Unknowns

LEAST_CAUTION = 1e-6

WORTH = 1e-6
"""Relative fall of the held-out loss that counts as one."""


@dataclass(frozen=True)
class Curriculum:
    """What all window lengths share: ``lengths`` in samples, ``mask`` (N,) of held-out samples, ``mean_square`` error of the physics, by
    which losses are divided, and ``spread`` (n_y,) of the outputs.
    """

    unknowns: Unknowns
    simulator: Simulator
    gradient: SequenceGradient
    settings: TrainingSettings
    lengths: tuple[int, ...]
    mask: np.ndarray
    mean_square: float
    spread: float

    @property
    def samples(self) -> int:
        """Samples that steps are taken on, which the penalty is shared among."""
        known = ~np.isnan(self.unknowns.hybrid.problem.records.y) & ~self.mask
        return max(int(known.sum()), 1)

    def stage(self, state: TrainingState) -> Stage:
        """The windows that ``state`` is at."""
        problem = self.unknowns.hybrid.problem
        return stage(problem, self.lengths[state.stage], state.starts, self.mask, self.settings.warm_up)

    def loss(self, z: np.ndarray, batch: Batch) -> float:
        """Mean squared error of a batch relative to that of the physics; infinite where the simulation is not finite."""
        values = self.unknowns.values(z)
        run = self.simulator.run(
            self.unknowns.hybrid.problem.model.prepared(batch.records, values),
            Pass(batch.windows, values, batch.starts, weights=self.unknowns.hybrid.problem.weights),
        )
        assert run.normal is not None
        energy = float(run.normal[:, -1, -1].sum())
        return energy / max(batch.samples, 1) / self.mean_square if np.isfinite(energy) else float("inf")

    def slope(self, z: np.ndarray, batch: Batch) -> tuple[float, np.ndarray] | None:
        """Loss of a batch with the penalty, and its gradient (d,) by the unknowns; None where the simulation is not finite."""
        found = self.gradient(self.unknowns.values(z), batch)
        if not found.finite:
            return None
        share = 1.0 / (max(batch.samples, 1) * self.mean_square)
        cost, pull = self.unknowns.cost(z)
        weight = self.settings.penalty / self.samples
        return share * found.energy + weight * cost, share * found.slope * self.unknowns.scale + weight * pull


def descend(course: Curriculum, state: TrainingState, on_epoch: Callable[[TrainingState], None]) -> None:
    """Carry ``state`` on to the end of the last window length; ``on_epoch`` is called at the end of every epoch.

    Raises:
        NumericalError: windows overflow at every step, however short.
    """
    settings = course.settings
    while state.stage < len(course.lengths):
        if state.epoch == 0:
            _begin(course, state)
        adam = Adam(state, settings.clip)
        while state.epoch < settings.epochs and state.waited < settings.patience:
            if state.epoch and state.epoch % settings.refresh == 0:
                _refresh(course, state)
            _epoch(course, state, adam)
            on_epoch(state)
        state.z, state.stage, state.epoch = state.best.copy(), state.stage + 1, 0


def _begin(course: Curriculum, state: TrainingState) -> None:
    """A new window length: start states from the shorter windows, moments and patience anew."""
    problem, length = course.unknowns.problem(state.z), course.lengths[state.stage]
    shorter = None if state.stage == 0 else (course.lengths[state.stage - 1], state.starts)
    state.starts = fitted_starts(problem, course.simulator, length, shorter=shorter)
    state.best, state.waited, state.steps = state.z.copy(), 0, 0
    state.best_loss = course.loss(state.z, course.stage(state).held_out_batch)


def _refresh(course: Curriculum, state: TrainingState) -> None:
    """The start states of the windows as the present parameters have them, and the best held-out loss with these."""
    problem, length = course.unknowns.problem(state.best), course.lengths[state.stage]
    state.starts = fitted_starts(problem, course.simulator, length, starts=state.starts)
    state.best_loss = course.loss(state.best, course.stage(state).held_out_batch)


def _epoch(course: Curriculum, state: TrainingState, adam: Adam) -> None:
    settings, windows = course.settings, course.stage(state)
    rng = np.random.default_rng()
    rng.bit_generator.state = state.generator
    rate = state.caution * learning_rate(settings.learning_rate, state.epoch, settings.epochs)
    losses = []
    for batch in windows.batches(settings.batch, rng):
        found = course.slope(state.z, batch)
        if found is None:
            _step_back(state)
            continue
        losses.append(found[0])
        state.z = course.unknowns.admitted(adam.proposed(state.z, found[1], rate), state.z)
    held_out = course.loss(state.z, windows.held_out_batch)
    if not np.isfinite(held_out):
        _step_back(state)
    state.waited += 1
    if held_out < (1.0 - WORTH) * state.best_loss:
        state.best, state.best_loss, state.waited = state.z.copy(), held_out, 0
    state.generator = rng.bit_generator.state  # type: ignore[assignment]
    if losses:
        adam.keep(state)
    state.epoch += 1
    fit = 100.0 * (1.0 - np.sqrt(held_out * course.mean_square) / course.spread)
    loss = float(np.mean(losses)) if losses else float("inf")
    state.history.append(Epoch(state.stage, state.epoch, loss, held_out, float(fit), rate))


def _step_back(state: TrainingState) -> None:
    """From where the simulation overflows to the best unknowns, with half the learning rate."""
    state.z, state.caution = state.best.copy(), 0.5 * state.caution
    if state.caution < LEAST_CAUTION:
        raise NumericalError(
            "training: the simulation of the windows overflows at every step, however short; try a lower learning rate, fewer units, "
            "or --freeze-physics"
        )
