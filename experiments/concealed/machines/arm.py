"""The three-mass arm in the proof: the plant and the catalogue of the standard set, with nuisances and an encoder beside."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.random import Generator

from experiments.concealed.case import (
    SMALLEST_LOADED_ARM,
    Case,
    assemble,
    draw_card,
    draw_truth,
    stays_within_estimation,
)
from experiments.concealed.catalogue.arm import CATALOGUE
from experiments.concealed.effects import Surroundings, Switches
from experiments.concealed.excitation import PRE_ROLL, Excitation, draw_excitation
from experiments.concealed.machines.base import LANES, Array, Channel, Machine, Run, Trial
from experiments.concealed.nuisances import Nuisances, draw_nuisances, nuisance_laws
from experiments.concealed.plant_arm import PARAMETERS, ArmPlant, Drive

RESOLUTION = 0.01  # rad/s of the speed that the encoder gives
TORQUE_NOISE = 0.01  # N m
DRIFT = 0.003  # N m
STEPS, ROUGH_STEPS, REPLAY_STEPS = 8, 4, 4


def _saturation(g: Generator, s: float, c: Surroundings) -> Switches:
    """Below the largest torque of this very trial: short recordings have lower peaks than the standard set's."""
    return {"limit": c.peak * float(np.exp(-s * g.uniform(0.1, 0.2)))}


class Arm(Machine):
    name = "arm"
    title = "Robot arm drive"
    model = "robot_arm"
    inputs = (Channel("torque", "u", "N m"),)
    outputs = (Channel("motor_speed", "y", "rad/s"),)
    sample_time = 0.001
    samples = 5000
    pre_roll = PRE_ROLL
    parameters = PARAMETERS
    known = ("J",)
    state_steps = (1e-3, 1e-3, 0.05, 0.05, 0.05)
    largest_scale = 4.0
    catalogue = {**CATALOGUE, "saturation": replace(CATALOGUE["saturation"], draw=_saturation)}

    @property
    def free(self) -> tuple[str, ...]:
        return tuple(name for name in PARAMETERS if name not in ("J", "alpha"))  # F_cs and beta say the same as alpha

    def draw_truth(self, rng: Generator, plan: Sequence[str]) -> dict[str, float]:
        truth = draw_truth(rng)
        loaded = any(self.catalogue[name].family == "arm_spring" or name == "arm_waves" for name in plan)
        while loaded and 1.0 - truth["a_m"] - truth["a_g"] < SMALLEST_LOADED_ARM:
            truth = draw_truth(rng)
        return truth

    def draw_card(self, rng: Generator, truth: Mapping[str, float]) -> dict[str, float]:
        return draw_card(rng, dict(truth))

    def draw_excitation(self, rng: Generator, plan: Sequence[str], noise: float) -> Excitation:
        drawn = draw_excitation(rng, self.samples, self.sample_time)
        while "end_stop" in plan and not stays_within_estimation(drawn, self.sample_time):
            drawn = draw_excitation(rng, self.samples, self.sample_time)
        return replace(drawn, noise=noise * drawn.noise)

    def draw_nuisances(self, rng: Generator) -> Nuisances:
        total = self.before + self.samples
        return draw_nuisances(rng, 1, total, self.sample_time, noise=TORQUE_NOISE, drift=DRIFT)

    def run(self, trials: Sequence[Trial], *, effects: bool = True, fine: bool = True) -> list[Run]:
        cases = [_case(trial, effects) for trial in trials]
        nuisances = nuisance_laws([t.nuisances for t in trials], "motor", ("sensor",), -PRE_ROLL)
        steps = STEPS if fine else ROUGH_STEPS
        plant, drive = assemble(cases, steps_per_sample=steps, nuisances=nuisances, resolution=RESOLUTION)
        start = np.empty((5, plant.lanes))

        def observe(sample: int, state: Array) -> None:
            if sample == self.before:
                start[:] = state[:5]

        whole = plant.run(plant.initial_state(np.zeros((3, plant.lanes))), drive, observe=observe, overflow=True)
        lanes = [slice(LANES * i, LANES * (i + 1)) for i in range(len(trials))]
        return [Run(whole.torque[:, w], whole.speed[None, :, w], whole.position[:, w], start[:, w]) for w in lanes]

    def replay(self, parameters: Mapping[str, Array], start: Array, command: Array) -> Array:
        lanes = start.shape[1]
        plant = ArmPlant(parameters, sample_time=self.sample_time, steps_per_sample=REPLAY_STEPS)
        state = plant.initial_state(start[2:])
        state[:2] = start[:2]
        nothing, zero = np.zeros((len(command), 1)), np.zeros(lanes)
        return plant.run(state, Drive(command, nothing, nothing, zero, zero), overflow=True).speed[None]


def _case(trial: Trial, effects: bool) -> Case:
    plan: dict[str, Any] = {"plan": trial.plan, "switches": trial.switches} if effects else {"plan": (), "switches": []}
    return Case(
        trial.name,
        trial.machine.sample_time,
        trial.seed,
        trial.number,
        strength=(),
        truth=trial.truth,
        card=trial.card,
        excitation=trial.excitation,
        **plan,
    )
