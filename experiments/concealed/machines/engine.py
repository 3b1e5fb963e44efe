"""What the machines in MuJoCo have in common: a joint for each degree of freedom, motors at some, the four kinds of experiment."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.random import Generator

from experiments.concealed.engine import run as engine
from experiments.concealed.engine.describe import ROUGH_STEP, STEP, Changes
from experiments.concealed.excitation import moves, multisine, slow_sweep
from experiments.concealed.machines.base import LANES, Array, Machine, Run, Trial
from experiments.concealed.nuisances import Nuisances, draw_nuisances

REPLAY_STEPS = 2
SWEEP = 0.7
"""Peak of the slow sweep, in strokes of the moves."""


@dataclass(frozen=True)
class EngineShaking:
    """Feedforward and reference (inputs, total, 4), noise (outputs, total, 4), gains by position and speed (inputs,)."""

    feedforward: Array
    reference: Array
    noise: Array
    gain: Array
    speed_gain: Array


class EngineMachine(Machine):
    """A machine in MuJoCo, and the equations of its plain model. States: positions of the joints, then their speeds."""

    sample_time = 0.002
    samples = 2000
    pre_roll = 0.5
    joints: ClassVar[tuple[str, ...]]
    driven: ClassVar[tuple[int, ...]]
    """Joints with a motor, by input."""
    followed: ClassVar[tuple[int, ...]]
    """Outputs that the feedback follows, by input."""
    output_rows: ClassVar[tuple[int, ...]]
    """Of the state, what the sensors show."""
    sensor_noise: ClassVar[tuple[float, ...]]
    resolution: ClassVar[tuple[float, ...]]
    shaking: ClassVar[tuple[float, ...]]
    """RMS of the broadband force, by input."""
    band: ClassVar[tuple[float, float]]
    """Its frequencies [Hz]."""
    travel: ClassVar[tuple[float, ...]]
    """Half the stroke of the moves, by input."""
    gains: ClassVar[tuple[tuple[float, float], ...]]
    """Of the feedback, by position and speed, by input; drawn 20 % about them."""
    corner: ClassVar[float] = 0.08
    torque_noise: ClassVar[float]
    drift: ClassVar[float]

    @abstractmethod
    def description(self, truth: Mapping[str, float], changes: Changes, step: float) -> str:
        """The machine in MuJoCo's language, with what is concealed in it."""

    @abstractmethod
    def accelerations(self, p: Mapping[str, Array], q: Array, v: Array, u: Array) -> Array:
        """Of the plain model, (joints, lanes), at positions q and speeds v (joints, lanes) under inputs u (inputs, lanes)."""

    def draw_excitation(self, rng: Generator, plan: Sequence[str], noise: float) -> EngineShaking:
        """Moves to and fro, twice; shaking around rest; a slow sweep."""
        drawn = self._drawn(rng, noise)
        while any(name.endswith("stop") for name in plan) and drawn.reference[0].max(axis=0).argmax() != 0:
            drawn = self._drawn(rng, noise)  # the estimation experiment has to get to the stop
        return drawn

    def _drawn(self, rng: Generator, noise: float) -> EngineShaking:
        total = self.before + self.samples
        feedforward, reference = [], []
        for level, stroke in zip(self.shaking, self.travel, strict=True):
            own = level * rng.uniform(0.8, 1.2)
            shaken = [own * multisine(rng, total, self.sample_time, *self.band) for _ in range(LANES)]
            feedforward.append(np.stack([*shaken[:3], 0.2 * shaken[3]], axis=1))
            paths = [moves(rng, total, self.samples, self.corner / self.sample_time) for _ in range(2)]
            sweep = SWEEP * slow_sweep(rng, total, self.samples)
            reference.append(stroke * np.stack([*paths, np.zeros(total), sweep], axis=1))
        size = noise * np.array(self.sensor_noise)[:, None, None]
        gain, speed_gain = (np.array(g) * rng.uniform(0.8, 1.2, len(g)) for g in zip(*self.gains, strict=True))
        return EngineShaking(
            np.array(feedforward),
            np.array(reference),
            size * rng.standard_normal((len(size), total, LANES)),
            gain,
            speed_gain,
        )

    def draw_nuisances(self, rng: Generator) -> Nuisances:
        total = self.before + self.samples
        return draw_nuisances(
            rng, len(self.outputs), total, self.sample_time, noise=self.torque_noise, drift=self.drift
        )

    def run(self, trials: Sequence[Trial], *, effects: bool = True, fine: bool = True) -> list[Run]:
        return [self._run(trial, effects, STEP if fine else ROUGH_STEP) for trial in trials]

    def _run(self, trial: Trial, effects: bool, step: float) -> Run:
        changes = {name: value for switches in trial.switches for name, value in switches.items()} if effects else {}
        xml, e = self.description(trial.truth, changes, step), trial.excitation
        found = []
        for lane in range(LANES):
            start = np.zeros(len(self.joints))
            start[list(self.driven)] = e.reference[:, 0, lane]
            found.append(
                engine.run(
                    xml,
                    engine.Feedback(
                        e.feedforward[:, :, lane].T, e.reference[:, :, lane].T, self.followed, e.gain, e.speed_gain
                    ),
                    engine.Sensing(
                        self.output_rows,
                        e.noise[:, :, lane].T,
                        trial.nuisances.jitter[:, :, lane].T,
                        trial.quiet * np.array(self.resolution),
                    ),
                    disturbance=trial.nuisances.disturbance[:, lane],
                    start=start,
                    sample_time=self.sample_time,
                    delay=changes.get("delay", 0.0),
                )
            )
        command = np.stack([one.command for one in found], axis=2)
        return Run(
            command[:, 0] if len(self.driven) == 1 else command,
            np.stack([one.outputs.T for one in found], axis=2),
            np.stack([one.states[:, self.driven[0]] for one in found], axis=1),
            np.stack([one.states[self.before] for one in found], axis=1),
        )

    def replay(self, parameters: Mapping[str, Array], start: Array, command: Array) -> Array:
        """By the classical Runge-Kutta rule."""
        u = command[:, None] if command.ndim == 2 else command
        state, rows = start.copy(), list(self.output_rows)
        shown = np.empty((len(rows), len(command), start.shape[1]))
        h, n = self.sample_time / REPLAY_STEPS, len(self.joints)

        def rates(s: Array, k: int) -> Array:
            return np.concatenate([s[n:], self.accelerations(parameters, s[:n], s[n:], u[k])])

        with np.errstate(over="ignore", invalid="ignore"):
            for k in range(len(command)):
                shown[:, k] = state[rows]
                for _ in range(REPLAY_STEPS):
                    a = rates(state, k)
                    b = rates(state + 0.5 * h * a, k)
                    c = rates(state + 0.5 * h * b, k)
                    d = rates(state + h * c, k)
                    state = state + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
        return shown
