"""What a network reads, by the names that a user knows: those of its port, and the states and inputs of the model."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.mechanisms.network import spoken
from greybox_torch.mechanisms.unknown import INPUT
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.along_motion import DIRECTION
from greybox_torch.model.own_rate import RATE
from greybox_torch.model.ports import Port
from greybox_torch.model.signals_elsewhere import DIFFERENCE, signals_elsewhere
from greybox_torch.model.within_turn import TURN_OF


def local_names(model: GreyBoxModel, port: Port, signals: Iterable[str]) -> tuple[str, ...]:
    """The ``signals`` by the names that laws at ``port`` know. A name of the port goes before one of the model, and what is neither is
    left as it is.
    """
    elsewhere = {theirs: name for name, theirs in _of_the_model(model, port).items()}
    own = {signal: name for name, signal in port.signals.items() if isinstance(signal, str)}
    known = {**elsewhere, **own, **{name: name for name in port.signals}}
    return tuple(known.get(signal, signal) for signal in signals)


def told_names(model: GreyBoxModel, port: Port, signals: Iterable[str]) -> tuple[str, ...]:
    """The reverse of :func:`local_names`: inputs and states at other ports by the names of the model, unless the port has such a name."""
    theirs = _of_the_model(model, port)
    told = {name: one for name, one in theirs.items() if local_names(model, port, (one,)) == (name,)}
    return tuple(told.get(signal, signal) for signal in signals)


def names_in_model(model: GreyBoxModel, port: Port, signals: Sequence[str]) -> tuple[str, ...]:
    """As :func:`told_names`, the signals of the port by the states that they are as well: the level of a balance is "air"."""
    own = {name: signal for name, signal in port.signals.items() if isinstance(signal, str)}
    own |= {kind: str(getattr(port, kind)) for kind in ("input", "output") if hasattr(port, kind)}
    found = zip(signals, told_names(model, port, signals), strict=True)
    return tuple(own.get(signal, told if told != signal else spoken(signal)) for signal, told in found)


def _of_the_model(model: GreyBoxModel, port: Port) -> dict[str, str]:
    """By the names that laws at ``port`` know, the model's own ones of its inputs and of the states at other ports."""
    elsewhere = {name: signal for name, signal in signals_elsewhere(model, port).items() if isinstance(signal, str)}
    return {**{f"{INPUT}{i.name}": i.name for i in model.inputs}, **elsewhere}


def readable(around: Surroundings) -> list[str]:
    """What a network may read at a port, by the names that laws know: no rate, which it changes itself; no difference from another level,
    as it would act on one of the two alone; no mere direction.
    """
    return [n for n in around.ranges if n != "delayed" and not n.startswith((RATE, TURN_OF, DIFFERENCE, DIRECTION))]
