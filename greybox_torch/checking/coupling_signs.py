"""Couplings whose port does not push back: the sign of the port, or of the deflection and its rate, is turned."""

from __future__ import annotations

from collections.abc import Iterator

import torch

from greybox_torch.checking.declarations import read_as
from greybox_torch.checking.finding import Finding
from greybox_torch.checking.points import Points
from greybox_torch.checking.slopes import slopes
from greybox_torch.checking.source import Source
from greybox_torch.model import Coupling, GreyBoxModel
from greybox_torch.model.ports import value_of


def pushes_on(model: GreyBoxModel, points: Points, source: Source) -> Iterator[Finding]:
    """A warning for every coupling of which a force at the port makes the deflection, or that one's rate, grow at all points.

    Whatever acts there beside it, and whether the coupling has a force of its own: between masses above zero a force that adds to the
    restoring one slows the deflection down. A massless coupling has it in the rate of the deflection itself.
    """
    x, u, p, f = points.signals(model)
    found = model.derivative(x, u, p, f)
    by_port = [slopes(torch.as_tensor(found[state.name]), (points.f,))[0] for state in model.states]
    for k, port in enumerate(model.ports):
        if not isinstance(port, Coupling):
            continue
        pushed = torch.stack([slope[k] for slope in by_port])
        for name in ("deflection", "rate"):
            (along,) = slopes(torch.as_tensor(value_of(port.signals[name], x, u, p)), (points.x,))
            grows = (along * pushed).sum(0)
            grows = grows[torch.isfinite(grows)]
            if not bool((grows != 0.0).any()):
                continue
            if bool((grows > 0.0).all()):
                written = read_as("port", port.name)
                yield Finding(
                    "warning",
                    "influence",
                    f"port '{port.name}': a force there drives the {name} on, where a coupling's force acts against it: laws that are "
                    "found there would have the wrong sign",
                    f"`{written}` with the sign of a spring's force there, or deflection and rate turned",
                    source.file,
                    source.line_of(written) or source.line_of(f'"{port.name}"') or source.line,
                )
            break
