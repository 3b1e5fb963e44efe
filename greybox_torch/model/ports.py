"""Ports: the places of a model where physics may be missing.

A port accepts an extra generalised force (N or N m), zero while nothing is attached. Positive pushes a body forward and adds to a
coupling's restoring force. Besides the declared ports every input has a port ``actuator`` and every output a port ``sensor``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

Signal = str | Callable[[Any, Any, Any], Any]
"""A state's name, or a function ``(x, u, p) -> tensor``."""


@dataclass(frozen=True)
class Body:
    """One mass: its speed, its position where the model has one, and the load it carries where that is known."""

    name: str
    speed: Signal
    position: Signal | None = None
    load: Signal | None = None

    @property
    def kind(self) -> str:
        """What a mechanism has to be made for to act here."""
        return "body"

    @property
    def signals(self) -> dict[str, Signal]:
        """What the model says of the place, by the names that mechanisms read."""
        pairs = {"speed": self.speed, "position": self.position, "load": self.load}
        return {name: signal for name, signal in pairs.items() if signal is not None}


@dataclass(frozen=True)
class Coupling:
    """A connection between two masses: its deflection and the deflection's rate."""

    name: str
    deflection: Signal
    rate: Signal

    @property
    def kind(self) -> str:
        """What a mechanism has to be made for to act here."""
        return "coupling"

    @property
    def signals(self) -> dict[str, Signal]:
        """What the model says of the place, by the names that mechanisms read."""
        return {"deflection": self.deflection, "rate": self.rate}


@dataclass(frozen=True)
class Balance:
    """Anything else that is a rate equation, with the level that it balances."""

    name: str
    level: Signal

    @property
    def kind(self) -> str:
        """What a mechanism has to be made for to act here."""
        return "balance"

    @property
    def signals(self) -> dict[str, Signal]:
        """What the model says of the place, by the names that mechanisms read."""
        return {"level": self.level}


@dataclass(frozen=True)
class Actuator:
    """The way from a recorded input to the input that acts."""

    name: str
    input: str

    @property
    def kind(self) -> str:
        """What a mechanism has to be made for to act here."""
        return "actuator"

    @property
    def signals(self) -> dict[str, Signal]:
        """What the model says of the place, by the names that mechanisms read."""
        name = self.input
        return {"input": lambda x, u, p: u[name]}


@dataclass(frozen=True)
class Sensor:
    """The way from a true output to the recorded one."""

    name: str
    output: str

    @property
    def kind(self) -> str:
        """What a mechanism has to be made for to act here."""
        return "sensor"

    @property
    def signals(self) -> dict[str, Signal]:
        """What the model says of the place, by the names that mechanisms read."""
        return {}


Port = Body | Coupling | Balance | Actuator | Sensor


def value_of(signal: Signal, x: Any, u: Any, p: Any) -> Any:
    """The value of a port's signal: a state, or a function of states, inputs and parameters."""
    return x[signal] if isinstance(signal, str) else signal(x, u, p)


def driving_body(ports: Iterable[Port]) -> Body | None:
    """The body whose position kinematic errors are taken to follow, and whose speed changes gains: the first declared one."""
    return next((port for port in ports if isinstance(port, Body)), None)


def integrates_position(ports: Iterable[Port], port: Port) -> bool:
    """Whether the position at a port is none of the model's own, but has to be integrated from the speed of its body."""
    body = port if isinstance(port, Body) else driving_body(ports)
    return body is not None and body.position is None


def actuators(inputs: tuple[str, ...]) -> tuple[Actuator, ...]:
    """The actuator ports of a model with these inputs: ``actuator``, or ``actuator.NAME`` where there are several."""
    return tuple(Actuator("actuator" if len(inputs) == 1 else f"actuator.{name}", name) for name in inputs)


def sensors(outputs: tuple[str, ...]) -> tuple[Sensor, ...]:
    """The sensor ports of a model with these outputs: ``sensor``, or ``sensor.NAME`` where there are several."""
    return tuple(Sensor("sensor" if len(outputs) == 1 else f"sensor.{name}", name) for name in outputs)
