"""One case: its true parameters, card values, excitation and concealed effects; and the simulation of many cases at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.random import Generator, SeedSequence
from numpy.typing import NDArray

from experiments.concealed.catalogue.arm import CATALOGUE
from experiments.concealed.effects import STRENGTHS, Effect, Surroundings
from experiments.concealed.excitation import EXPERIMENTS, PRE_ROLL, Excitation, draw_excitation
from experiments.concealed.laws import Law
from experiments.concealed.plant_arm import (
    NOMINAL,
    PARAMETERS,
    SAMPLE_TIME,
    STEPS_PER_SAMPLE,
    ArmPlant,
    Drive,
    Recordings,
)

Array = NDArray[np.float64]

NEEDS_POSITIONS = ("end_stop", "notch")
SMALLEST_ARM = 0.03  # of the whole inertia
SMALLEST_LOADED_ARM = 0.07  # where the effect sits in the spring of the arm, which a light arm hardly winds


class Concealing(Protocol):
    """What has effects with their switches: a case of any machine."""

    @property
    def effects(self) -> list[Effect]: ...

    switches: list[dict[str, float]]


@dataclass
class Case:
    """Everything drawn for one case; `switches` holds one dictionary per concealed effect."""

    name: str
    sample_time: float
    seed: int
    number: int
    plan: tuple[str, ...]
    strength: tuple[str, ...]
    truth: dict[str, float]
    card: dict[str, float]
    excitation: Excitation
    switches: list[dict[str, float]]

    @property
    def effects(self) -> list[Effect]:
        return [CATALOGUE[name] for name in self.plan]


def draw_truth(rng: Generator) -> dict[str, float]:
    """True parameters around the optimum of the published recordings: J and alpha known, the others some 20 % about it."""
    truth = {name: NOMINAL[name] * float(np.exp(rng.uniform(-0.22, 0.22))) for name in PARAMETERS}
    truth["J"], truth["alpha"] = NOMINAL["J"], NOMINAL["alpha"]
    truth["a_m"] = min(truth["a_m"], 0.32)
    truth["a_g"] = min(truth["a_g"], 0.66, 1.0 - SMALLEST_ARM - truth["a_m"])
    return truth


def draw_card(rng: Generator, truth: dict[str, float]) -> dict[str, float]:
    """Start values up to 15 % off the truth; J is known."""
    card = {name: float(f"{truth[name] * (1.0 + rng.uniform(-0.15, 0.15)):.6g}") for name in PARAMETERS}
    card["J"] = float(f"{truth['J']:.5g}")
    card["a_g"] = min(card["a_g"], round(0.97 - card["a_m"], 6))
    return card


def draw_case(
    seed: int,
    number: int,
    plan: tuple[str, ...],
    *,
    samples: int,
    strength: str = "moderate",
    sample_time: float = SAMPLE_TIME,
) -> Case:
    """Draw one case. `strength` is one of `STRENGTHS`, or "drawn" for one at random per effect."""
    rng = np.random.default_rng(SeedSequence([seed, 1 + number]))
    truth = draw_truth(rng)
    at_the_arm = any(CATALOGUE[name].family == "arm_spring" or name == "arm_waves" for name in plan)
    while at_the_arm and 1.0 - truth["a_m"] - truth["a_g"] < SMALLEST_LOADED_ARM:
        truth = draw_truth(rng)
    card = draw_card(rng, truth)
    excitation = draw_excitation(rng, samples, sample_time)
    while "end_stop" in plan and not stays_within_estimation(excitation, sample_time):
        excitation = draw_excitation(rng, samples, sample_time)
    strengths = tuple(str(rng.choice(list(STRENGTHS))) if strength == "drawn" else strength for _ in plan)
    case = Case(f"c{number:03d}", sample_time, seed, number, plan, strengths, truth, card, excitation, [])
    position = np.zeros((samples, len(EXPERIMENTS)))
    if any(name in NEEDS_POSITIONS for name in plan):
        position = simulate_cases([replace(case, plan=())], steps_per_sample=1)[0].position
    surroundings = Surroundings(truth, position)
    for effect, word in zip(case.effects, strengths, strict=True):
        drawn = effect.draw(rng, STRENGTHS[word], surroundings)
        case.switches.append({name: float(value) for name, value in drawn.items()})
    return case


def stays_within_estimation(excitation: Excitation, sample_time: float) -> bool:
    """Whether the fast slow-profile experiment never goes past where the estimation experiment turns back."""
    before = round(PRE_ROLL / sample_time)
    position = np.cumsum(excitation.reference, axis=0)[before:] * sample_time
    return bool(position[:, 3].max() < position[:, 0].max() - 2.0)


def simulate_cases(cases: list[Case], *, steps_per_sample: int = STEPS_PER_SAMPLE) -> list[Recordings]:
    """Simulate all cases, of one sample time and length, side by side with their effects.

    One `Recordings` of shape (samples, 4) each, the pre-roll cut.
    """
    plant, drive = assemble(cases, steps_per_sample=steps_per_sample)
    everything = plant.run(plant.initial_state(np.zeros((3, plant.lanes))), drive)
    arrays = (everything.torque, everything.speed, everything.position)
    cut, count = round(PRE_ROLL / plant.sample_time), len(EXPERIMENTS)
    return [Recordings(*(a[cut:, count * i : count * (i + 1)] for a in arrays)) for i in range(len(cases))]


def assemble(
    cases: list[Case],
    *,
    steps_per_sample: int = STEPS_PER_SAMPLE,
    nuisances: Sequence[Law] = (),
    resolution: float = 0.0,
) -> tuple[ArmPlant, Drive]:
    """The plant of all cases with their effects, and what drives it; lane 4 i + j is experiment j of case i.

    `nuisances` are further laws on these lanes, `resolution` the step in which the speed is read out [rad/s].
    """
    count, sample_time = len(EXPERIMENTS), cases[0].sample_time
    parameters = {name: np.repeat([case.truth[name] for case in cases], count) for name in PARAMETERS}
    plant = ArmPlant(
        parameters,
        [*concealed_laws(cases), *nuisances],
        sample_time=sample_time,
        steps_per_sample=steps_per_sample,
        start_time=-PRE_ROLL,
    )
    drive = Drive(
        np.concatenate([case.excitation.feedforward for case in cases], axis=1),
        np.concatenate([case.excitation.reference for case in cases], axis=1),
        np.concatenate([case.excitation.noise for case in cases], axis=1),
        np.repeat([case.excitation.gain for case in cases], count),
        np.repeat([case.excitation.integral_gain for case in cases], count),
        resolution,
    )
    return plant, drive


def concealed_laws(cases: Sequence[Concealing]) -> list[Law]:
    """One law for every effect of the catalogue that occurs, on the lanes of the cases that conceal it."""
    occurrences: dict[str, list[tuple[int, dict[str, float]]]] = {}
    known: dict[str, Effect] = {}
    for i, case in enumerate(cases):
        for effect, switches in zip(case.effects, case.switches, strict=True):
            occurrences.setdefault(effect.name, []).append((i, switches))
            known[effect.name] = effect
    laws: list[Law] = []
    count = len(EXPERIMENTS)
    for name, found in occurrences.items():
        lanes = np.concatenate([count * i + np.arange(count) for i, _ in found])
        values = {key: np.repeat([float(one[key]) for _, one in found], count) for key in found[0][1]}
        laws.append(known[name].law(lanes, values, known[name].port))
    return laws
