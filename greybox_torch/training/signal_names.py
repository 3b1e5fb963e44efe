"""What a network reads, by the names that a user knows: those of its port, and the states and inputs of the model."""

from __future__ import annotations

from collections.abc import Iterable

from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.mechanisms.unknown import INPUT
from greybox_torch.model import Balance, GreyBoxModel
from greybox_torch.model.own_rate import RATE
from greybox_torch.model.ports import Port
from greybox_torch.model.signals_elsewhere import LEVEL
from greybox_torch.model.within_turn import TURN_OF


def local_names(model: GreyBoxModel, port: Port, signals: Iterable[str]) -> tuple[str, ...]:
    """The ``signals`` by the names that laws at ``port`` know. A name of the port goes before one of the model, and what is neither is
    left as it is.
    """
    levels = {q.level: f"{LEVEL}{q.name}" for q in model.ports if isinstance(q, Balance) and isinstance(q.level, str)}
    own = {signal: name for name, signal in port.signals.items() if isinstance(signal, str)}
    inputs = {i.name: f"{INPUT}{i.name}" for i in model.inputs}
    known = {**inputs, **levels, **own, **{name: name for name in port.signals}}
    return tuple(known.get(signal, signal) for signal in signals)


def readable(around: Surroundings) -> list[str]:
    """What a network may read at a port, by the names that laws know: no rate, which it changes itself."""
    return [n for n in around.ranges if n != "delayed" and not n.startswith((RATE, TURN_OF))]


def spoken(signal: str) -> str:
    """A signal as it is told: an input by its name, that of another port with the port's."""
    if signal.startswith(INPUT):
        return signal.removeprefix(INPUT)
    name, _, port = signal.partition("@")
    return f"{name} of {port}" if port else name
