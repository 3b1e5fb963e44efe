"""What the proof asks of a machine, and one trial of it: true parameters, excitation, nuisances and concealed effects."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.random import Generator, SeedSequence
from numpy.typing import NDArray

from experiments.concealed.effects import Effect, Surroundings
from experiments.concealed.excitation import EXPERIMENTS
from experiments.concealed.nuisances import Nuisances

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Channel:
    """A recorded signal: the model's name for it, the column of the file, its unit."""

    name: str
    column: str
    unit: str


@dataclass
class Trial:
    """One machine with what was drawn for it. Lanes are its four experiments, in the order of `EXPERIMENTS`.

    `visibility`: RMS error, in units of the floor, that stays when the plain model is refitted (see `visibility.py`); `beside`: by effect
    of a pair, what it adds beside the other, likewise; `floor`: by output, what the refit leaves of the noise and the nuisances alone;
    `sigma`: what the true model leaves of them in free runs.
    """

    name: str
    machine: Machine
    seed: int
    number: int
    plan: tuple[str, ...]
    truth: dict[str, float]
    card: dict[str, float]
    excitation: Any
    nuisances: Nuisances
    section: str = "library"
    estimation: str = "estimation"
    noise: float = 1.0
    quiet: float = 1.0
    targets: tuple[float, ...] = ()
    scales: list[float] = field(default_factory=list)
    switches: list[dict[str, float]] = field(default_factory=list)
    visibility: float = 0.0
    beside: tuple[float, ...] = ()
    floor: tuple[float, ...] = ()
    sigma: tuple[float, ...] = ()

    @property
    def effects(self) -> list[Effect]:
        return [self.machine.catalogue[name] for name in self.plan]

    def draw_switches(self, plain: Run) -> None:
        """Set the effects' switches at the present `scales`. What is drawn beside the strength does not depend on it.

        `plain` is the run without effect, of which some draws depend.
        """
        before = self.machine.before
        peak = float(np.abs(plain.command[before:, ..., 0]).max())
        around = Surroundings(self.truth, plain.position[before:], peak)
        self.switches = []
        for effect, scale in zip(self.effects, self.scales, strict=True):
            word = sum(ord(letter) * (i + 1) for i, letter in enumerate(effect.name))
            rng = np.random.default_rng(SeedSequence([self.seed, 3, self.number, word]))
            drawn = effect.draw(rng, scale, around)
            self.switches.append({name: float(value) for name, value in drawn.items()})


@dataclass(frozen=True)
class Run:
    """What one trial's four experiments gave, the run before the recording included.

    command (total, 4), or (total, inputs, 4) where a machine has several; outputs (channels, total, 4), position (total, 4); start (states
    of the plain model, 4) where the recording begins.
    """

    command: Array
    outputs: Array
    position: Array
    start: Array


class Machine(ABC):
    """A machine of the proof. Units: those of its channels."""

    name: ClassVar[str]
    title: ClassVar[str]
    model: ClassVar[str]
    """The model's name on the card."""
    model_file: ClassVar[Path | None] = None
    inputs: ClassVar[tuple[Channel, ...]]
    outputs: ClassVar[tuple[Channel, ...]]
    sample_time: ClassVar[float]
    samples: ClassVar[int]
    pre_roll: ClassVar[float] = 1.0
    """Seconds that run unrecorded before each recording, so that it starts in motion."""
    parameters: ClassVar[tuple[str, ...]]
    known: ClassVar[tuple[str, ...]]
    """Parameters that the card fixes at their true values."""
    state_steps: ClassVar[tuple[float, ...]]
    """Of the plain model's states, for sensitivities by differences."""
    catalogue: ClassVar[Mapping[str, Effect]]
    largest_scale: ClassVar[float] = 12.0
    """Times the catalogue's strength that is still a machine: some effects cannot be made to dominate."""

    @property
    def before(self) -> int:
        """Samples before the recording."""
        return round(self.pre_roll / self.sample_time)

    @property
    def free(self) -> tuple[str, ...]:
        return tuple(name for name in self.parameters if name not in self.known)

    @abstractmethod
    def draw_truth(self, rng: Generator, plan: Sequence[str]) -> dict[str, float]: ...

    @abstractmethod
    def draw_excitation(self, rng: Generator, plan: Sequence[str], noise: float) -> Any:
        """What drives the four experiments; the sensor's noise is `noise` times its usual size."""

    @abstractmethod
    def draw_nuisances(self, rng: Generator) -> Nuisances: ...

    @abstractmethod
    def run(self, trials: Sequence[Trial], *, effects: bool = True, fine: bool = True) -> list[Run]:
        """Simulate under feedback, all trials side by side, with or without their effects; `fine`: with the full number of steps."""

    @abstractmethod
    def replay(self, parameters: Mapping[str, Array], start: Array, command: Array) -> Array:
        """Outputs (channels, samples, lanes) of the plain machine from start (states, lanes) on command (samples, lanes)."""

    def draw_card(self, rng: Generator, truth: Mapping[str, float]) -> dict[str, float]:
        """Start values up to 15 % off the truth; what is known is exact."""
        return {
            name: float(f"{truth[name] * (1.0 if name in self.known else 1.0 + rng.uniform(-0.15, 0.15)):.6g}")
            for name in self.parameters
        }

    def draw(
        self,
        seed: int,
        number: int,
        plan: tuple[str, ...],
        *,
        noise: float = 1.0,
        quiet: float = 1.0,
        **fields: Any,
    ) -> Trial:
        """Draw one trial; the strength of its effects is set by `scaling.calibrate`.

        `noise` is that of the sensors, times the usual; `quiet` is what the sensors' noise and all nuisances are multiplied with.
        """
        rng = np.random.default_rng(SeedSequence([seed, 2, number]))
        truth = self.draw_truth(rng, plan)
        return Trial(
            name=f"t{number:03d}",
            machine=self,
            seed=seed,
            number=number,
            plan=plan,
            truth=truth,
            card=self.draw_card(rng, truth),
            excitation=self.draw_excitation(rng, plan, noise * quiet),
            nuisances=self.draw_nuisances(rng).times(quiet),
            noise=noise,
            quiet=quiet,
            scales=[1.0] * len(plan),
            **fields,
        )


LANES = len(EXPERIMENTS)
