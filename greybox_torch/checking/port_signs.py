"""Ports whose force acts the wrong way: the sign of the port, or of the signals declared with it, is turned."""

from __future__ import annotations

from collections.abc import Iterator

import torch

from greybox_torch.checking.declarations import read_as
from greybox_torch.checking.finding import Finding
from greybox_torch.checking.points import Points
from greybox_torch.checking.slopes import slopes
from greybox_torch.checking.source import Source
from greybox_torch.model import Balance, Body, Coupling, GreyBoxModel
from greybox_torch.model.ports import Port, value_of

_MOVED = {Body: ("speed", "position"), Coupling: ("deflection", "rate"), Balance: ("level",)}
"""The signals that a force at a port moves, by its kind. The first of them that it moves directly counts: a massless body has no rate of
its speed, and a massless coupling has the force in the rate of the deflection itself. A level that is a function is left out: what goes
through an exchanger's plates levels a difference of temperatures.
"""


def turned_ports(model: GreyBoxModel, points: Points, source: Source) -> Iterator[Finding]:
    """A warning for every body and balance of which a force at the port lowers the speed or level at all points, and every coupling of
    which it raises the deflection or its rate.

    Whatever acts there beside it, and whether the coupling has a force of its own: between masses above zero a force pushes the body that
    it acts on forward, and one that adds to a restoring force slows the deflection down.
    """
    x, u, p, f = points.signals(model)
    found = model.derivative(x, u, p, f)
    by_port = [slopes(torch.as_tensor(found[state.name]), (points.f,))[0] for state in model.states]
    for k, port in enumerate(model.ports):
        if not isinstance(port, Body | Coupling | Balance):
            continue
        pushed = torch.stack([slope[k] for slope in by_port])
        right = -1.0 if isinstance(port, Coupling) else 1.0
        for name in _MOVED.get(type(port), ()):
            signal = port.signals.get(name)
            if signal is None or (isinstance(port, Balance) and not isinstance(signal, str)):
                continue
            (along,) = slopes(torch.as_tensor(value_of(signal, x, u, p)), (points.x,))
            grows = (along * pushed).sum(0)
            grows = grows[torch.isfinite(grows)]
            if not bool((grows != 0.0).any()):
                continue
            if bool((right * grows < 0.0).all()):
                written = read_as("port", port.name)
                what, write = _told(port, name)
                yield Finding(
                    "warning",
                    "influence",
                    f"port '{port.name}': {what}: laws that are found there would have the wrong sign",
                    f"`{written}` {write}",
                    source.file,
                    source.line_of(written) or source.line_of(f'"{port.name}"') or source.line,
                )
            break


def _told(port: Port, signal: str) -> tuple[str, str]:
    """What a turned port does, and how its term is to be written."""
    if isinstance(port, Coupling):
        return (
            f"a force there drives the {signal} on, where a coupling's force acts against it",
            "with the sign of a spring's force there, or deflection and rate turned",
        )
    if isinstance(port, Body):
        return (
            f"a force above zero there lowers the {signal}, where it pushes a body forward",
            "with the sign of a force that drives the body, or speed and position turned",
        )
    return (
        f"what is added there lowers the {signal}, where it raises it",
        "with the sign of what flows in, or the level turned",
    )
