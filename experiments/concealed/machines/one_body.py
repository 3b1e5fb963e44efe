"""What a positioning stage and a pendulum have in common: one body, position feedback, the four kinds of experiment."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from experiments.concealed.case import concealed_laws
from experiments.concealed.excitation import moves, multisine, slow_sweep
from experiments.concealed.machines.base import LANES, Array, Machine, Run, Trial
from experiments.concealed.nuisances import Nuisances, draw_nuisances, nuisance_laws
from experiments.concealed.plant_body import BodyDrive, BodyPlant

STEPS, ROUGH_STEPS, REPLAY_STEPS = 10, 4, 3


@dataclass(frozen=True)
class Shaking:
    """One trial's four experiments: feedforward and reference (total, 4), noise (outputs, total, 4), and the feedback's two gains."""

    feedforward: Array
    reference: Array
    noise: Array
    gain: float
    speed_gain: float


class OneBody(Machine):
    """A machine with one body, of which `sensors` measure position and, perhaps, speed."""

    body: ClassVar[str]
    sensors: ClassVar[tuple[str, ...]]
    state_steps = (1e-4, 1e-3)
    output_rows: ClassVar[tuple[int, ...]]
    sensor_noise: ClassVar[tuple[float, ...]]
    resolution: ClassVar[tuple[float, ...]]
    shaking: ClassVar[float]
    """RMS of the broadband force."""
    band: ClassVar[tuple[float, float]]
    """Its frequencies [Hz]."""
    move, sweep = 1.0, 1.0
    """Half the stroke of the moves, and of the slow sweep."""
    corner: ClassVar[float] = 0.08
    """Lag of the corners of a move [s], twice."""
    torque_noise: ClassVar[float]
    drift: ClassVar[float]

    @abstractmethod
    def physics(self, parameters: Mapping[str, Array]) -> tuple[Array, Array, Array]:
        """Inertia, damping and gravity."""

    @abstractmethod
    def gains(self, rng: Generator) -> tuple[float, float]:
        """Of the feedback, by position and by speed."""

    def draw_excitation(self, rng: Generator, plan: Sequence[str], noise: float) -> Shaking:
        """Moves to and fro, twice; shaking around rest; a slow sweep over the whole travel. As for the arm, with positions."""
        drawn = self._drawn(rng, noise)
        while {"end_stop", "hard_end_stop"} & set(plan) and drawn.reference.max(axis=0).argmax() != 0:
            drawn = self._drawn(
                rng, noise
            )  # where the estimation experiment never gets to the stop, nothing can be said of it
        return drawn

    def _drawn(self, rng: Generator, noise: float) -> Shaking:
        total = self.before + self.samples
        level = self.shaking * rng.uniform(0.8, 1.2)
        shaken = [level * multisine(rng, total, self.sample_time, *self.band) for _ in range(3)]
        feedforward = np.stack([*shaken, 0.2 * level * multisine(rng, total, self.sample_time, *self.band)], axis=1)
        lag = self.corner / self.sample_time
        paths = [self.move * moves(rng, total, self.samples, lag) for _ in range(2)]
        sweep = self.sweep * slow_sweep(rng, total, self.samples)
        reference = np.stack([*paths, np.zeros(total), sweep], axis=1)
        size = np.array(self.sensor_noise)[:, None, None]
        return Shaking(
            feedforward, reference, noise * size * rng.standard_normal((len(size), total, 4)), *self.gains(rng)
        )

    def draw_nuisances(self, rng: Generator) -> Nuisances:
        total = self.before + self.samples
        return draw_nuisances(
            rng, len(self.outputs), total, self.sample_time, noise=self.torque_noise, drift=self.drift
        )

    def run(self, trials: Sequence[Trial], *, effects: bool = True, fine: bool = True) -> list[Run]:
        truth = {name: np.repeat([t.truth[name] for t in trials], LANES) for name in self.parameters}
        laws = concealed_laws(trials) if effects else []
        laws += nuisance_laws([t.nuisances for t in trials], self.body, self.sensors, -self.pre_roll)
        plant = self._plant(truth, laws, STEPS if fine else ROUGH_STEPS, -self.pre_roll)
        start = np.empty((2, plant.lanes))

        def observe(sample: int, state: Array) -> None:
            if sample == self.before:
                start[:] = state[:2]

        everything = [t.excitation for t in trials]
        drive = BodyDrive(
            np.concatenate([e.feedforward for e in everything], axis=1),
            np.concatenate([e.reference for e in everything], axis=1),
            np.concatenate([e.noise for e in everything], axis=2),
            np.repeat([e.gain for e in everything], LANES),
            np.repeat([e.speed_gain for e in everything], LANES),
            np.array(self.resolution),
        )
        state = plant.initial_state(drive.reference[0], np.zeros(plant.lanes))
        whole = plant.run(state, drive, observe=observe)
        lanes = [slice(LANES * i, LANES * (i + 1)) for i in range(len(trials))]
        return [Run(whole.command[:, w], whole.outputs[:, :, w], whole.position[:, w], start[:, w]) for w in lanes]

    def replay(self, parameters: Mapping[str, Array], start: Array, command: Array) -> Array:
        plant = self._plant(parameters, [], REPLAY_STEPS, 0.0)
        lanes, outputs = plant.lanes, len(self.outputs)
        nothing = np.zeros((len(command), lanes))
        silent = BodyDrive(
            command,
            nothing,
            np.zeros((outputs, len(command), 1)),
            np.zeros(lanes),
            np.zeros(lanes),
            np.zeros(outputs),
        )
        return plant.run(plant.initial_state(start[0], start[1]), silent).outputs

    def _plant(self, parameters: Mapping[str, Array], laws: list, steps: int, start_time: float) -> BodyPlant:
        return BodyPlant(
            *self.physics(parameters),
            laws,
            output_rows=self.output_rows,
            sensors=self.sensors,
            sample_time=self.sample_time,
            steps_per_sample=steps,
            start_time=start_time,
        )
