"""A machine of the workshop: its plain equations with a force at every port, its sensors and actuators, and what can be concealed in it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from experiments.concealed.workshop.laws import PortLaw

Array = NDArray[np.float64]
Pair = tuple[str, str]
State = Sequence[float]
MODELS = Path(__file__).parent / "models"


@dataclass(frozen=True)
class Channel:
    """An input or output: its name in the model, its column in the files, the model's unit, and the model's value per value in the file.

    `counts`: the file holds whole numbers, of an encoder.
    """

    name: str
    column: str
    unit: str
    scale: float = 1.0
    counts: bool = False


@dataclass(frozen=True)
class Port:
    """Where a law acts: position (or level) and rate there; `sign`: +1 where the model's force opposes it (a coupling), else -1."""

    position: Callable[[State, Mapping[str, float]], float]
    rate: Callable[[State, Mapping[str, float]], float]
    sign: float = -1.0


@dataclass
class Concealed:
    """What is concealed: laws at ports, and changes of actuators and sensors by channel (delay, lag, dead, limit, gain, bias)."""

    laws: list[tuple[str, PortLaw]] = field(default_factory=list)
    actuators: dict[str, dict[str, float]] = field(default_factory=dict)
    sensors: dict[str, dict[str, float]] = field(default_factory=dict)

    def join(self, other: Concealed) -> Concealed:
        return Concealed(
            self.laws + other.laws, _both(self.actuators, other.actuators), _both(self.sensors, other.sensors)
        )


def _both(some: Mapping[str, dict[str, float]], others: Mapping[str, dict[str, float]]) -> dict[str, dict[str, float]]:
    """The changes of both, by channel."""
    return {name: {**some.get(name, {}), **others.get(name, {})} for name in {**some, **others}}


@dataclass(frozen=True)
class Seen:
    """What a draw may go by: the true parameters, and the plain machine's states, inputs and outputs (experiments, samples, …)."""

    truth: Mapping[str, float]
    states: Array
    inputs: Array
    outputs: Array

    def reach(self, at: Callable[[State, Mapping[str, float]], float]) -> tuple[float, float]:
        """Smallest and largest value of a signal in the first experiment."""
        values = [at(row, self.truth) for row in self.states[0]]
        return min(values), max(values)

    def usual(self, at: Callable[[State, Mapping[str, float]], float]) -> float:
        """RMS of a signal in the first experiment."""
        return float(np.sqrt(np.mean([at(row, self.truth) ** 2 for row in self.states[0]])))


@dataclass(frozen=True)
class Entry:
    """An entry of a machine's catalogue."""

    draw: Callable[[Generator, Seen], Concealed]
    accept: tuple[Pair, ...]
    near: tuple[Pair, ...] = ()
    ports: tuple[str, ...] = ()
    family: str = ""
    outside: bool = False
    beside: tuple[Entry, ...] = ()
    """What comes with it and has a name of its own."""

    @property
    def places(self) -> tuple[str, ...]:
        return self.ports or tuple(dict.fromkeys(port for port, _ in self.accept))


@dataclass(frozen=True)
class Drive:
    """One experiment: feedforward and reference (samples, inputs); per input the output that is followed and the two gains."""

    feedforward: Array
    reference: Array
    followed: tuple[int, ...] = ()
    gain: tuple[float, ...] = ()
    speed_gain: tuple[float, ...] = ()


class Machine(ABC):
    """One machine. States, inputs, outputs and parameters in the order of the lists."""

    name: ClassVar[str]
    model: ClassVar[str]
    """The class in `models/NAME.py`."""
    sample_time: ClassVar[float]
    samples: ClassVar[int] = 1500
    substeps: ClassVar[int] = 10
    experiments: ClassVar[int] = 3
    unstable: ClassVar[bool] = False
    """Whether it falls without its feedback, so that no simulation on recorded inputs alone stays near."""
    states: ClassVar[tuple[str, ...]]
    inputs: ClassVar[tuple[Channel, ...]]
    outputs: ClassVar[tuple[Channel, ...]]
    truth: ClassVar[dict[str, float]]
    known: ClassVar[tuple[str, ...]] = ()
    ports: ClassVar[dict[str, Port]]
    catalogue: ClassVar[dict[str, Entry]]

    @abstractmethod
    def rates(self, s: State, u: Sequence[float], p: Mapping[str, float], f: Mapping[str, float]) -> list[float]:
        """Of the states, with the model's forces `f` at its ports."""

    @abstractmethod
    def show(self, s: State, p: Mapping[str, float]) -> list[float]:
        """What the sensors show, in the model's units."""

    @abstractmethod
    def drive(self, rng: Generator, number: int, p: Mapping[str, float]) -> Drive:
        """How experiment `number` is driven."""

    def start(self, rng: Generator, p: Mapping[str, float]) -> list[float]:
        """The states before an experiment begins; at rest."""
        return [0.0] * len(self.states)

    @property
    def model_file(self) -> Path:
        return MODELS / f"{self.name}.py"

    def draw_truth(self, rng: Generator) -> dict[str, float]:
        """About 20 % around the usual values."""
        return {
            name: float(f"{value * np.exp(rng.uniform(-0.2, 0.2)):.5g}" if name not in self.known else value)
            for name, value in self.truth.items()
        }
